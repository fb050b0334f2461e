#include "robot_vision/meshes/mesh_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/meshes/mesh_camera.hpp"
#include "core/meshes/mesh_raster.hpp"
#include "core/meshes/mesh_scratch.hpp"
#include "core/meshes/mesh_shading.hpp"
#include "core/meshes/mesh_surface.hpp"
#include "core/meshes/vertex_kernels.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxSide = 16384;  // px
constexpr int kMaxIndex = 65534;
constexpr double kMaxPose = 1e6;  // m; what is farther away is not seen, and its numbers could overflow
constexpr float kMargin = 0.01F;  // px, by which numbers of seven digits may be wrong in an image of that size
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

void requireRegion(const MeshCamera& camera, const cv::Rect& region)
{
  // No text is made where nothing is wrong: that would take longer than to draw a small mesh.
  if (region.width < 1 || region.height < 1 || region.width > kMaxSide || region.height > kMaxSide)
    require(false, "region", toText(region.size()), "from 1x1 to 16384x16384");
  if (camera.lens() == nullptr) return;
  const cv::Rect image(cv::Point(), camera.lens()->size);
  if ((region & image) != region)
    require(false, "region", toText(region.size()),
            "within the image of " + toText(image.size()) + " of a camera with distortion");
}

void requirePose(const cv::Affine3d& pose)
{
  for (const double value : pose.matrix.val)
    if (!(std::abs(value) <= kMaxPose)) require(false, "pose", value, "finite and at most 1e6");
}

/// Of an image that is drawn to: one that is `wanted`, and any that is there.
void requireImage(const char* name, const cv::Mat& image, int type, const cv::Size& size, bool wanted)
{
  if (image.empty() ? !wanted : image.type() == type && image.size() == size) return;
  require(false, name, toText(image.size()), toText(size) + " of the type that render() makes");
}

/// Makes a part of a view that is asked for, or drops it.
void clear(cv::Mat& image, int type, const cv::Size& size, const cv::Scalar& value, bool wanted)
{
  if (!wanted)
  {
    image.release();
    return;
  }
  image.create(size, type);
  image.setTo(value);
}

}  // namespace

struct MeshRenderer::Impl
{
  explicit Impl(const Mesh& mesh);

  SeenBounds see(const MeshCamera& camera, const cv::Affine3d& pose, const cv::Point& corner,
                 std::vector<SeenVertex>& seen) const;
  SeenTriangles trianglesFacing(const MeshCamera& camera, const cv::Affine3d& pose, std::vector<int>& facing) const;
  void draw(const MeshCamera& camera, const cv::Affine3d& pose, const cv::Rect& region, MeshView& view,
            const RenderParts& parts, int index) const;

  MeshExtent extent;
  MeshLook look;
  std::vector<float> points[3];
  std::vector<float> planes[4];  // a x + b y + c z + d, above 0 where a triangle is seen from, in the mesh's frame
};

MeshRenderer::Impl::Impl(const Mesh& mesh) : extent(meshExtent(mesh)), look(mesh, meshSurface(mesh).outsides)
{
  for (const cv::Vec3f& vertex : mesh.vertices)
    for (int axis = 0; axis < 3; ++axis)
      points[axis].push_back(vertex[axis]);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
  {
    const cv::Vec3d normal = static_cast<double>(look.outsides[i]) * cv::Vec3d(look.flat_normals[i]);
    const cv::Vec3d corner = mesh.vertices[static_cast<std::size_t>(mesh.triangles[i][0])];
    const bool flat = look.flat_normals[i] == cv::Vec3f();  // a line or a point, which is never seen
    for (int axis = 0; axis < 3; ++axis)
      planes[axis].push_back(static_cast<float>(normal[axis]));
    planes[3].push_back(static_cast<float>(flat ? -1.0 : look.outsides[i] == 0 ? 1.0 : -normal.dot(corner)));
  }
}

SeenBounds MeshRenderer::Impl::see(const MeshCamera& camera, const cv::Affine3d& pose, const cv::Point& corner,
                                   std::vector<SeenVertex>& seen) const
{
  const cv::Matx33d shift(1, 0, -corner.x, 0, 1, -corner.y, 0, 0, 1);
  const cv::Matx34d in_camera = pose.matrix.get_minor<3, 4>(0, 0);
  const cv::Matx34d matrix = camera.lens() == nullptr ? shift * camera.K() * in_camera : in_camera;
  seen.resize(points[0].size());
  const float* from[3] = {points[0].data(), points[1].data(), points[2].data()};
  const auto count = static_cast<int>(points[0].size());
  const SeenBounds bounds = kernels<VertexKernels>().transform(from, count, matrix.val, seen.data());
  return camera.lens() == nullptr ? bounds : bend(*camera.lens(), corner, bounds.min_w, seen);
}

SeenTriangles MeshRenderer::Impl::trianglesFacing(const MeshCamera& camera, const cv::Affine3d& pose,
                                                  std::vector<int>& facing) const
{
  facing.resize(look.triangles.size() + 1);  // the kernel writes one more than it counts
  const cv::Vec3f eye = -(pose.rotation().t() * pose.translation());
  const float* from[4] = {planes[0].data(), planes[1].data(), planes[2].data(), planes[3].data()};
  const auto count = static_cast<int>(look.triangles.size());
  const int found = kernels<VertexKernels>().facing(from, count, eye.val, facing.data());
  const MeshCamera::Lens* lens = camera.lens();
  return {look.triangles[0].val,
          facing.data(),
          found,
          kNearest,
          lens != nullptr ? static_cast<float>(lens->margin) : kMargin,
          lens != nullptr ? static_cast<float>(lens->bend) : 0.0F};
}

void MeshRenderer::Impl::draw(const MeshCamera& camera, const cv::Affine3d& pose, const cv::Rect& region,
                              MeshView& view, const RenderParts& parts, int index) const
{
  if (!view.scratch) view.scratch = std::make_shared<MeshView::Scratch>();
  MeshView::Scratch& scratch = *view.scratch;
  const SeenBounds bounds = see(camera, pose, region.tl(), scratch.seen);
  const SeenTriangles triangles = trianglesFacing(camera, pose, scratch.facing);
  const cv::Rect part = seenPart(bounds, triangles, region.size());
  if (part.empty()) return;
  const Raster raster = makeRaster(camera, region, part, view.depth, scratch);
  kernels<RasterKernels>().draw(scratch.seen.data(), triangles, raster);
  Shading shading;
  shading.rotation = pose.rotation();
  shading.place = part;
  shading.id = index + 1;
  shading.to_light = cv::normalize(parts.to_light);
  if (camera.lens() != nullptr)
  {
    dropUnseen(camera, region.tl(), part, raster);
    shading.to_ray = cv::Matx33f::eye();
    shading.step = cv::Vec2d(1.0 / camera.K()(0, 0), 1.0 / camera.K()(1, 1));
  }
  else
  {
    const cv::Matx33d shift(1, 0, region.x, 0, 1, region.y, 0, 0, 1);
    shading.to_ray = camera.K().inv() * shift;
    shading.step = {1.0F, 1.0F};
  }
  shade(look, scratch.seen.data(), triangles, raster, shading, scratch.shading, view);
}

MeshRenderer::MeshRenderer(const Mesh& mesh) : impl_(std::make_unique<const Impl>(mesh))
{
}

MeshRenderer::~MeshRenderer() = default;
MeshRenderer::MeshRenderer(MeshRenderer&&) noexcept = default;
MeshRenderer& MeshRenderer::operator=(MeshRenderer&&) noexcept = default;

const MeshExtent& MeshRenderer::extent() const
{
  return impl_->extent;
}

void MeshRenderer::render(const MeshCamera& camera, const cv::Affine3d& pose, const cv::Rect& region, MeshView& view,
                          const RenderParts& parts) const
{
  requireRegion(camera, region);
  requirePose(pose);
  clear(view.depth, CV_32FC1, region.size(), cv::Scalar::all(kNan), true);
  clear(view.bgr, CV_8UC3, region.size(), {}, parts.bgr);
  clear(view.normals, CV_32FC3, region.size(), cv::Scalar::all(kNan), parts.normals);
  clear(view.ids, CV_16UC1, region.size(), {}, parts.ids);
  impl_->draw(camera, pose, region, view, parts, 0);
}

void MeshRenderer::merge(const MeshCamera& camera, const cv::Affine3d& pose, const cv::Rect& region, MeshView& view,
                         const RenderParts& parts, int index) const
{
  requireRegion(camera, region);
  requirePose(pose);
  requireRange("index", index, 0, kMaxIndex);
  requireImage("depth", view.depth, CV_32FC1, region.size(), true);
  requireImage("bgr", view.bgr, CV_8UC3, region.size(), parts.bgr);
  requireImage("normals", view.normals, CV_32FC3, region.size(), parts.normals);
  requireImage("ids", view.ids, CV_16UC1, region.size(), parts.ids);
  impl_->draw(camera, pose, region, view, parts, index);
}

}  // namespace robot_vision
