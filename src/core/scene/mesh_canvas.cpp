// Draws meshes: through the lens, as all else.

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "scene_canvas.hpp"

namespace robot_vision::scene
{
namespace
{

/// The part of the image in which meshes are seen, in pixels.
cv::Rect partOf(const std::vector<PlacedMesh>& meshes, const CameraModel& camera)
{
  const cv::Rect image(0, 0, camera.width, camera.height);
  cv::Rect part;
  for (const PlacedMesh& mesh : meshes)
  {
    const MeshExtent& extent = mesh.renderer->extent();
    std::vector<cv::Point2f> corners;
    for (int corner = 0; corner < 8; ++corner)
    {
      const cv::Vec3d sign(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
      const cv::Point3d point = mesh.pose * cv::Point3d(extent.center + extent.size.mul(sign));
      if (!(point.z > 0.0)) return image;
      corners.emplace_back(camera.project(point));
    }
    const int margin = 4;  // px, for the lens, which bends edges outwards
    cv::Rect box = cv::boundingRect(corners);
    box -= cv::Point(margin, margin);
    box += cv::Size(2 * margin, 2 * margin);
    part |= box & image;
  }
  return part;
}

/// Draws them in the part of the image of a camera.
MeshView drawAll(const std::vector<PlacedMesh>& meshes, const MeshCamera& camera, const cv::Rect& part,
                 const RenderParts& parts)
{
  MeshView view;
  for (const PlacedMesh& mesh : meshes)
    if (&mesh == &meshes.front())
      mesh.renderer->render(camera, mesh.pose, part, view, parts);
    else
      mesh.renderer->merge(camera, mesh.pose, part, view, parts, static_cast<int>(&mesh - &meshes.front()));
  return view;
}

/// Lays colors (0 where nothing is) over an image; `covered` is their share of each pixel, 0 to 255.
void layOver(const cv::Mat& colors, const cv::Mat& covered, cv::Mat image)
{
  for (int row = 0; row < image.rows; ++row)
  {
    const uchar* from = colors.ptr(row);
    const uchar* share = covered.ptr(row);
    uchar* to = image.ptr(row);
    for (int i = 0; i < 3 * image.cols; ++i)
      to[i] = static_cast<uchar>(std::min((to[i] * (255 - share[i / 3]) + 127) / 255 + from[i], 255));
  }
}

}  // namespace

void ColorCanvas::meshes(const std::vector<PlacedMesh>& meshes, const cv::Vec3d& to_light)
{
  const cv::Rect part = partOf(meshes, lens_.camera);
  if (part.empty()) return;
  RenderParts parts;
  parts.bgr = true;
  parts.to_light = to_light;
  const MeshView view = drawAll(meshes, lens_.for_meshes.quarters(), {part.tl() * 2, part.size() * 2}, parts);
  // Each pixel is the mean of its four quarters.
  cv::Mat colors, covered;
  cv::resize(view.bgr, colors, part.size(), 0, 0, cv::INTER_AREA);
  cv::resize(view.depth > 0.0, covered, part.size(), 0, 0, cv::INTER_AREA);
  layOver(colors, covered, bgr_(part));
}

void DepthCanvas::meshes(const std::vector<PlacedMesh>& meshes, const cv::Vec3d& /*to_light*/)
{
  const cv::Rect part = partOf(meshes, lens_.camera);
  if (part.empty()) return;
  const MeshView view = drawAll(meshes, lens_.for_meshes.pixels(), part, RenderParts());
  for (int row = 0; row < part.height; ++row)
  {
    const float* from = view.depth.ptr<float>(row);
    float* to = depth_.ptr<float>(part.y + row) + part.x;
    for (int column = 0; column < part.width; ++column)
      if (from[column] > 0.0F) to[column] = std::max(to[column], 1.0F / from[column]);
  }
}

}  // namespace robot_vision::scene
