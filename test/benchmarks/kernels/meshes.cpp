#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core/affine.hpp>

#include "contests.hpp"
#include "robot_vision/meshes/mesh_renderer.hpp"
#include "robot_vision/meshes/sample_meshes.hpp"

namespace bench
{
namespace
{

using robot_vision::Mesh;

const float kNan = std::numeric_limits<float>::quiet_NaN();

cv::Vec3d cornerOf(const Mesh& mesh, int vertex)
{
  return mesh.vertices[static_cast<std::size_t>(vertex)];
}

/// A z-buffer as it is written in a tutorial: for each triangle, each pixel of the box around it.
class PlainRenderer
{
public:
  cv::Mat depth, normals;

  void render(const Mesh& mesh, const cv::Matx33d& K, const cv::Affine3d& pose, const cv::Size& size)
  {
    depth.create(size, CV_32FC1);
    normals.create(size, CV_32FC3);
    depth.setTo(kNan);
    normals.setTo(cv::Scalar::all(kNan));
    for (const cv::Vec3i& triangle : mesh.triangles)
      draw(mesh, triangle, K, pose);
  }

private:
  void draw(const Mesh& mesh, const cv::Vec3i& triangle, const cv::Matx33d& K, const cv::Affine3d& pose)
  {
    cv::Vec3d points[3], pixels[3];
    for (int i = 0; i < 3; ++i)
    {
      points[i] = pose * cornerOf(mesh, triangle[i]);
      pixels[i] = K * points[i] / points[i][2];
    }
    const cv::Vec3d &a = pixels[0], &b = pixels[1], &c = pixels[2];
    const double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (area >= 0.0) return;  // its back
    const auto from = [](double x) { return std::max(static_cast<int>(std::ceil(x)), 0); };
    const int left = from(std::min({a[0], b[0], c[0]})), top = from(std::min({a[1], b[1], c[1]}));
    const int right = std::min(static_cast<int>(std::max({a[0], b[0], c[0]})), depth.cols - 1);
    const int bottom = std::min(static_cast<int>(std::max({a[1], b[1], c[1]})), depth.rows - 1);
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x)
      {
        const double u = ((b[0] - x) * (c[1] - y) - (b[1] - y) * (c[0] - x)) / area;
        const double v = ((c[0] - x) * (a[1] - y) - (c[1] - y) * (a[0] - x)) / area, w = 1.0 - u - v;
        if (u < 0.0 || v < 0.0 || w < 0.0) continue;
        const cv::Vec3d weights(u / points[0][2], v / points[1][2], w / points[2][2]);
        const double z = 1.0 / (weights[0] + weights[1] + weights[2]);
        float& there = depth.at<float>(y, x);
        if (there <= z) continue;
        there = static_cast<float>(z);
        cv::Vec3d normal;
        for (int i = 0; i < 3; ++i)
          normal += weights[i] * cv::Vec3d(mesh.normals[static_cast<std::size_t>(triangle[i])]);
        normals.at<cv::Vec3f>(y, x) = cv::normalize(pose.rotation() * normal);
      }
  }
};

/// A duck that fills half of the image's height, from the front, the sides and behind.
struct RenderingState
{
  explicit RenderingState(const Setup& setup)
    : mesh(robot_vision::sampleMesh("duck").mesh), renderer(mesh), size(setup.frames.front().size())
  {
    const double focal = 1.2 * size.height;
    K = {focal, 0, 0.5 * size.width, 0, focal, 0.5 * size.height, 0, 0, 1};
    parts.normals = true;
  }

  cv::Affine3d poseAt(std::size_t i) const
  {
    const double turn = 0.3 * static_cast<double>(i);
    return cv::Affine3d(cv::Vec3d(0.5 * CV_PI, 0, 0), cv::Vec3d(0, 0, 0.3)) * cv::Affine3d(cv::Vec3d(0, 0, turn)) *
           cv::Affine3d(cv::Matx33d::eye(), -renderer.extent().center);
  }

  void byOpenCv(std::size_t i) { theirs.render(mesh, K, poseAt(i), size); }
  void byUs(std::size_t i) { renderer.render(K, poseAt(i), cv::Rect(cv::Point(), size), ours, parts); }

  /// The same pixels but for some at the outline, and the same surface.
  bool same() const
  {
    const cv::Mat both = (ours.depth > 0.0) & (theirs.depth > 0.0);
    const int different = cv::countNonZero((ours.depth > 0.0) ^ (theirs.depth > 0.0));
    return different < 20 && cv::countNonZero(both) > size.area() / 20 &&
           cv::norm(ours.depth, theirs.depth, cv::NORM_L1, both) / cv::countNonZero(both) < 1e-5 &&
           cv::norm(ours.normals, theirs.normals, cv::NORM_L1, both) / cv::countNonZero(both) < 1e-2;
  }

  Mesh mesh;
  robot_vision::MeshRenderer renderer;
  cv::Size size;
  cv::Matx33d K;
  robot_vision::RenderParts parts;
  PlainRenderer theirs;
  robot_vision::MeshView ours;
};

}  // namespace

std::vector<Work> meshWorks()
{
  return {{"depth and normals of a mesh of 7,608 triangles", "a plain z-buffer", 1.5, contestOf<RenderingState>()}};
}

}  // namespace bench
