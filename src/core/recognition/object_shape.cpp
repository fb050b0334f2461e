#include "robot_vision/recognition/object_shape.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "look_alikes.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr int kViews = 150;          // directions that are about 18 degrees apart
constexpr int kSide = 48;            // px, of the images that points are taken from
constexpr double kDistance = 4.0;    // of the viewer, in diameters
constexpr int kPoints = 96;          // of a view, at most
constexpr float kMinCosine = 0.25F;  // between normal and ray, of points that are seen well

/// The directions of a spiral from one pole to the other, whose turns are as far apart as its points.
cv::Vec3d spiralDirection(int i)
{
  const double golden = CV_PI * (3.0 - std::sqrt(5.0));
  const double z = 1.0 - (2.0 * i + 1.0) / kViews, radius = std::sqrt(1.0 - z * z);
  return {radius * std::cos(golden * i), radius * std::sin(golden * i), z};
}

/// The rotation of the mesh before a camera that sees it from this direction.
cv::Matx33d seenFrom(const cv::Vec3d& direction)
{
  const cv::Vec3d z = -direction;
  const cv::Vec3d any = std::abs(z[0]) < 0.6 ? cv::Vec3d(1, 0, 0) : cv::Vec3d(0, 1, 0);
  const cv::Vec3d x = cv::normalize(any.cross(z)), y = z.cross(x);
  return {x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2]};
}

bool isColored(const Mesh& mesh)
{
  const auto [least, most] = std::minmax({mesh.color[0], mesh.color[1], mesh.color[2]});
  const bool has_texture = std::any_of(mesh.triangle_textures.begin(), mesh.triangle_textures.end(),
                                       [](int texture) { return texture >= 0; });
  return has_texture || !mesh.colors.empty() || most > least + most / 8;
}

}  // namespace

struct ObjectShape::Impl
{
  Impl(const Mesh& mesh, const SymmetryGroup& group) : renderer(mesh), symmetries(group), has_colors(isColored(mesh))
  {
    const MeshExtent& extent = renderer.extent();
    require(extent.diameter > 0.0, "the diameter of the mesh", extent.diameter, "above 0");
    if (symmetries.axis()) free_axes.push_back({extent.center, *symmetries.axis()});
    for (int i = 0; i < 3 && symmetries.isBall(); ++i)
      free_axes.push_back({extent.center, cv::Vec3d(i == 0 ? 1 : 0, i == 1 ? 1 : 0, i == 2 ? 1 : 0)});
    MeshView drawn;
    views.reserve(kViews);
    for (int i = 0; i < kViews; ++i)
      views.push_back(viewOf(spiralDirection(i), drawn));
    if (has_colors) look_alikes = findLookAlikes(renderer);
  }

  SurfaceView viewOf(const cv::Vec3d& direction, MeshView& drawn) const
  {
    const MeshExtent& extent = renderer.extent();
    const double distance = kDistance * extent.diameter, middle = 0.5 * (kSide - 1);
    const double focus = kSide * std::sqrt(distance * distance - extent.radius * extent.radius) / (2.0 * extent.radius);
    const cv::Matx33d K(focus, 0, middle, 0, focus, middle, 0, 0, 1), rotation = seenFrom(direction);
    const cv::Affine3d pose(rotation, cv::Vec3d(0, 0, distance) - rotation * extent.center);
    RenderParts parts;
    parts.normals = true;
    renderer.render(K, pose, cv::Rect(0, 0, kSide, kSide), drawn, parts);
    const auto seen = [&](int x, int y)
    {
      const cv::Vec3f ray(static_cast<float>((x - middle) / focus), static_cast<float>((y - middle) / focus), 1.0F);
      return drawn.depth.at<float>(y, x) > 0.0F &&
             -drawn.normals.at<cv::Vec3f>(y, x).dot(ray) > kMinCosine * static_cast<float>(cv::norm(ray));
    };
    SurfaceView view;
    view.direction = direction;
    const cv::Matx33d back = rotation.t();
    for (const cv::Point& pixel : spread(seen))
    {
      const cv::Vec3d ray((pixel.x - middle) / focus, (pixel.y - middle) / focus, 1.0);
      const cv::Vec3d from_center = static_cast<double>(drawn.depth.at<float>(pixel)) * ray - cv::Vec3d(0, 0, distance);
      view.points.emplace_back(back * from_center);
      view.normals.emplace_back(back * cv::Vec3d(drawn.normals.at<cv::Vec3f>(pixel)));
    }
    return view;
  }

  /// At most kPoints of the pixels that are seen, on a grid.
  template <class Seen>
  static std::vector<cv::Point> spread(const Seen& seen)
  {
    for (int step = 1;; ++step)
    {
      std::vector<cv::Point> pixels;
      for (int y = step / 2; y < kSide; y += step)
        for (int x = step / 2; x < kSide; x += step)
          if (seen(x, y)) pixels.emplace_back(x, y);
      if (pixels.size() <= kPoints) return pixels;
    }
  }

  MeshRenderer renderer;
  SymmetryGroup symmetries;
  std::vector<FreeAxis> free_axes;
  bool has_colors;
  std::vector<SurfaceView> views;
  std::vector<cv::Matx33d> look_alikes;
};

ObjectShape::ObjectShape(const Mesh& mesh, const std::vector<Symmetry>& symmetries)
  : impl_(std::make_unique<const Impl>(mesh, SymmetryGroup(symmetries)))
{
}

ObjectShape::~ObjectShape() = default;

const MeshRenderer& ObjectShape::renderer() const
{
  return impl_->renderer;
}

const SymmetryGroup& ObjectShape::symmetries() const
{
  return impl_->symmetries;
}

const std::vector<FreeAxis>& ObjectShape::freeAxes() const
{
  return impl_->free_axes;
}

const std::vector<cv::Matx33d>& ObjectShape::lookAlikes() const
{
  return impl_->look_alikes;
}

bool ObjectShape::hasColors() const
{
  return impl_->has_colors;
}

const SurfaceView& ObjectShape::viewFrom(const cv::Vec3d& direction) const
{
  const cv::Vec3f wanted = direction;
  return *std::max_element(impl_->views.begin(), impl_->views.end(),
                           [&](const SurfaceView& a, const SurfaceView& b)
                           { return a.direction.dot(wanted) < b.direction.dot(wanted); });
}

}  // namespace robot_vision
