#include "robot_vision/depth/depth_volume.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/geometry/rigid_motion.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/depth/depth_image.hpp"
#include "robot_vision/image/encoding.hpp"
#include "surface_nets.hpp"

namespace robot_vision
{
namespace
{

constexpr double kTruncation = 4.0;  // voxels, up to which a distance from the surface is told
constexpr double kMaxVoxels = 16e6;
constexpr double kMaxLength = 1000.0;  // m
constexpr int kOutlineMargin = 3;      // px, by which an outline may be wrong
constexpr int kMinOutside = 2;         // images without a depth there, that tell that something is not the object
constexpr float kColored = 0.5F;       // of the truncation, from the surface, up to where a voxel has its color
constexpr double kPieceShare = 0.05;   // of the triangles of the largest piece

cv::Vec3d sizeOf(const VolumeParams& params)
{
  const cv::Vec3d voxels = (params.high - params.low) * (1.0 / params.voxel);
  return {std::ceil(voxels[0]), std::ceil(voxels[1]), std::ceil(voxels[2])};
}

void check(const cv::Mat& bgr, const cv::Mat& depth, const cv::Mat& mask, const CameraModel& camera,
           const cv::Affine3d& pose)
{
  validate(camera);
  requireRigid(pose, "the pose of the object");
  const cv::Size size(camera.width, camera.height);
  checkPixels(bgr, "bgr8");
  require(bgr.size() == size, "the size of the image", toText(bgr.size()), toText(size) + " as of its camera");
  checkDepth(depth, "32FC1", size);
  require(mask.type() == CV_8UC1 && mask.size() == size, "the mask", toText(mask.size()), "CV_8UC1 of " + toText(size));
}

/// The sums of the normals of the triangles around each vertex, made as long as 1.
std::vector<cv::Vec3f> normalsOf(const NetSurface& surface)
{
  std::vector<cv::Vec3f> normals(surface.vertices.size());
  for (const cv::Vec3i& triangle : surface.triangles)
  {
    const auto vertex = [&](int i) { return surface.vertices[static_cast<std::size_t>(triangle[i])]; };
    const cv::Vec3f across = (vertex(1) - vertex(0)).cross(vertex(2) - vertex(0));
    for (int i = 0; i < 3; ++i)
      normals[static_cast<std::size_t>(triangle[i])] += across;
  }
  for (cv::Vec3f& normal : normals)
  {
    const auto length = static_cast<float>(cv::norm(normal));
    normal = length > 0.0F ? normal * (1.0F / length) : cv::Vec3f(0.0F, 0.0F, 1.0F);
  }
  return normals;
}

}  // namespace

void validate(const VolumeParams& params)
{
  for (int i = 0; i < 3; ++i)
  {
    requireRange("a corner of the volume", params.low[i], -kMaxLength, kMaxLength);
    requireRange("a corner of the volume", params.high[i], params.low[i], kMaxLength);
  }
  require(params.voxel > 0.0 && params.voxel <= kMaxLength, "voxel", params.voxel, "above 0 m");
  requireFinite("floor", params.floor);
  const cv::Vec3d size = sizeOf(params);
  require(std::min({size[0], size[1], size[2]}) >= 2.0, "the smallest side of the volume",
          std::min({size[0], size[1], size[2]}), "at least 2 voxels");
  require(size[0] * size[1] * size[2] <= kMaxVoxels, "the number of voxels", size[0] * size[1] * size[2],
          "at most " + toText(kMaxVoxels));
}

DepthVolume::DepthVolume(const VolumeParams& params) : params_((validate(params), params)), size_(sizeOf(params))
{
  const auto count = [this](int i) { return static_cast<std::size_t>(size_[i]); };
  voxels_.resize(count(0) * count(1) * count(2));
}

cv::Vec3d DepthVolume::middleOf(const cv::Vec3i& at) const
{
  return params_.low + (cv::Vec3d(at) + cv::Vec3d::all(0.5)) * params_.voxel;
}

std::size_t DepthVolume::indexOf(const cv::Vec3i& at) const
{
  return (static_cast<std::size_t>(at[2]) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(at[1])) *
             static_cast<std::size_t>(size_[0]) +
         static_cast<std::size_t>(at[0]);
}

void DepthVolume::add(const cv::Mat& bgr, const cv::Mat& depth, const cv::Mat& mask, const CameraModel& camera,
                      const cv::Affine3d& pose)
{
  check(bgr, depth, mask, camera, pose);
  constexpr std::uint16_t kMost = std::numeric_limits<std::uint16_t>::max();
  const auto truncation = static_cast<float>(kTruncation * params_.voxel);
  cv::Mat outline;
  const int side = 2 * kOutlineMargin + 1;
  cv::dilate(mask, outline, cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side}));
  for (cv::Vec3i at(0, 0, 0); at[2] < size_[2]; ++at[2])
    for (at[1] = 0; at[1] < size_[1]; ++at[1])
      for (at[0] = 0; at[0] < size_[0]; ++at[0])
      {
        const cv::Vec3d point = pose * middleOf(at);
        const cv::Point2d seen = camera.project(cv::Point3d(point));
        if (!(seen.x > -0.5 && seen.y > -0.5 && seen.x < camera.width - 0.5 && seen.y < camera.height - 0.5)) continue;
        const cv::Point pixel(cvRound(seen.x), cvRound(seen.y));
        Voxel& voxel = voxels_[indexOf(at)];
        if (outline.at<uchar>(pixel) == 0 && voxel.outside < kMost) ++voxel.outside;
        const auto distance = (depth.at<float>(pixel) - static_cast<float>(point[2])) / truncation;
        if (!(distance >= -1.0F) || voxel.weight == kMost) continue;  // behind the surface, or there is no depth
        voxel.distance += std::min(distance, 1.0F);
        ++voxel.weight;
        if (mask.at<uchar>(pixel) == 0 || std::abs(distance) > kColored) continue;
        voxel.color += cv::Vec3f(bgr.at<cv::Vec3b>(pixel));
        ++voxel.colors;
      }
}

double DepthVolume::valueOf(const Voxel& voxel) const
{
  if (voxel.weight > 0) return voxel.distance / static_cast<double>(voxel.weight);
  return voxel.outside >= kMinOutside ? 1.0 : -1.0;
}

/// The distances, with a margin around them that is outside, so that the surface is closed.
std::vector<float> DepthVolume::values() const
{
  const cv::Vec3i padded = size_ + cv::Vec3i::all(2);
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(padded[0]) * static_cast<std::size_t>(padded[1]) *
                 static_cast<std::size_t>(padded[2]));
  const int lowest = std::clamp(cvCeil((params_.floor - params_.low[2]) / params_.voxel), 0, size_[2] - 1);
  for (int z = -1; z <= size_[2]; ++z)
    for (int y = -1; y <= size_[1]; ++y)
      for (int x = -1; x <= size_[0]; ++x)
      {
        const bool is_margin = x < 0 || y < 0 || z < 0 || x == size_[0] || y == size_[1] || z == size_[2];
        values.push_back(is_margin ? 1.0F : static_cast<float>(valueOf(voxels_[indexOf({x, y, std::max(z, lowest)})])));
      }
  return values;
}

std::vector<cv::Vec3b> DepthVolume::colorsAt(const std::vector<cv::Vec3f>& places) const
{
  cv::Vec3f mean;
  float count = 0.0F;
  std::vector<cv::Vec3b> colors;
  std::vector<std::size_t> unknown;
  for (const cv::Vec3f& place : places)
  {
    cv::Vec3i at;
    for (int i = 0; i < 3; ++i)
      at[i] = std::clamp(cvRound(place[i]) - 1, 0, size_[i] - 1);
    const Voxel& voxel = voxels_[indexOf(at)];
    if (voxel.colors == 0) unknown.push_back(colors.size());
    const cv::Vec3f color = voxel.color * (1.0F / static_cast<float>(std::max<int>(voxel.colors, 1)));
    colors.emplace_back(cv::saturate_cast<uchar>(color[0]), cv::saturate_cast<uchar>(color[1]),
                        cv::saturate_cast<uchar>(color[2]));
    mean += color;
    count += voxel.colors > 0 ? 1.0F : 0.0F;
  }
  mean *= 1.0F / std::max(count, 1.0F);
  for (const std::size_t i : unknown)
    colors[i] = {cv::saturate_cast<uchar>(mean[0]), cv::saturate_cast<uchar>(mean[1]),
                 cv::saturate_cast<uchar>(mean[2])};
  return colors;
}

Mesh DepthVolume::mesh() const
{
  NetSurface surface = surfaceNets(values(), size_ + cv::Vec3i::all(2));
  keepLargePieces(kPieceShare, surface);
  require(!surface.triangles.empty(), "the surface of the object", "not to be seen", "within the volume");
  Mesh mesh;
  mesh.triangles = surface.triangles;
  mesh.normals = normalsOf(surface);
  mesh.colors = colorsAt(surface.vertices);
  for (const cv::Vec3f& place : surface.vertices)
    mesh.vertices.emplace_back(params_.low + (cv::Vec3d(place) - cv::Vec3d::all(0.5)) * params_.voxel);
  validate(mesh);
  return mesh;
}

}  // namespace robot_vision
