#include "texture_keypoints.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "core/geometry/rigid_motion.hpp"
#include "core/image/rects.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/depth/depth_image.hpp"
#include "robot_vision/features/keypoints.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMargin = 24;               // px around the object that are searched, so that its outline looks as it is
constexpr double kInsideShare = 0.6;      // of a keypoint's radius that must be on the object
constexpr float kMaxDepthSpread = 0.02F;  // of the depth, around a keypoint: what is more is an edge of the object
constexpr int kMaxFeatures = 5000;
constexpr double kMaxEnlarging = 2.0;  // times, of a view that is small

void check(const TextureView& view)
{
  validate(view.camera);
  requireRigid(view.pose, "the pose of a view");
  const cv::Size size(view.camera.width, view.camera.height);
  checkPixels(view.image, view.image.channels() == 1 ? "mono8" : "bgr8");
  require(view.image.size() == size, "the size of a view's image", toText(view.image.size()),
          toText(size) + " as of its camera");
  checkDepth(view.depth, "32FC1", size);
  require(view.mask.empty() || (view.mask.type() == CV_8UC1 && view.mask.size() == size), "the mask of a view",
          toText(view.mask.size()), "CV_8UC1 of " + toText(size));
}

/// A part of a view that has all of the object, in gray.
struct ObjectPart
{
  cv::Rect region;  // px
  cv::Mat gray;
  cv::Mat depth;  // CV_32FC1, m, NaN where the object is not
  cv::Mat reach;  // CV_32FC1, px: how far it is from each pixel to one that is not the object's
};

std::optional<ObjectPart> objectPart(const TextureView& view)
{
  cv::Mat mask = view.depth == view.depth;  // not NaN
  if (!view.mask.empty()) mask &= view.mask != 0;
  const cv::Rect box = cv::boundingRect(mask);
  if (box.empty()) return std::nullopt;
  const cv::Point margin(kMargin, kMargin);
  ObjectPart part;
  part.region = cv::Rect(box.tl() - margin, box.br() + margin) & fullRect(mask);
  toGray(view.image(part.region), view.image.channels() == 1 ? "mono8" : "bgr8", part.gray);
  const cv::Mat own = mask(part.region);
  cv::distanceTransform(view.mask.empty() ? own : view.mask(part.region) != 0, part.reach, cv::DIST_L2, 3);
  part.depth = cv::Mat(own.size(), CV_32FC1, cv::Scalar(NAN));
  view.depth(part.region).copyTo(part.depth, own);
  return part;
}

/// The depth around a pixel, by its median; NaN at edges, and where there is too little.
float depthAt(const cv::Mat& depth, const cv::Point& pixel)
{
  std::array<float, 9> near = {};
  std::size_t count = 0;
  for (int y = std::max(pixel.y - 1, 0); y <= std::min(pixel.y + 1, depth.rows - 1); ++y)
    for (int x = std::max(pixel.x - 1, 0); x <= std::min(pixel.x + 1, depth.cols - 1); ++x)
      if (const float z = depth.at<float>(y, x); z > 0.0F && std::isfinite(z)) near[count++] = z;
  if (count < 5) return NAN;
  std::sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count));
  const float middle = near[count / 2];
  return near[count - 1] - near[0] > kMaxDepthSpread * middle ? NAN : middle;
}

/// Finds keypoints in an image that was made smaller or larger, and tells them in px of the full one.
Keypoints keypointsAt(const cv::Mat& gray, double scale, const KeypointParams& params)
{
  const cv::Size size(std::max(cvRound(gray.cols * scale), 1), std::max(cvRound(gray.rows * scale), 1));
  cv::Mat pixels = gray;
  if (size != gray.size()) cv::resize(gray, pixels, size, 0.0, 0.0, scale < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);
  Keypoints found = findKeypoints(pixels, "mono8", params, true);
  const float fx = static_cast<float>(gray.cols) / static_cast<float>(size.width);
  const float fy = static_cast<float>(gray.rows) / static_cast<float>(size.height);
  for (cv::KeyPoint& key : found.all)
  {
    key.pt = {(key.pt.x + 0.5F) * fx - 0.5F, (key.pt.y + 0.5F) * fy - 0.5F};
    key.size *= fx;
  }
  return found;
}

std::optional<TexturePoint> pointOf(const cv::KeyPoint& key, const ObjectPart& part, const TextureView& view,
                                    const cv::Affine3d& from_camera)
{
  const cv::Point pixel(cvRound(key.pt.x), cvRound(key.pt.y));
  if (!fullRect(part.gray).contains(pixel)) return std::nullopt;
  if (part.reach.at<float>(pixel) < kInsideShare * 0.5 * key.size) return std::nullopt;
  const double z = depthAt(part.depth, pixel);
  const cv::Point2d ray = view.camera.ray(cv::Point2d(key.pt) + cv::Point2d(part.region.tl()));
  if (!std::isfinite(z) || !std::isfinite(ray.x) || !std::isfinite(ray.y)) return std::nullopt;
  const cv::Vec3d position = from_camera * cv::Vec3d(ray.x * z, ray.y * z, z);
  const double pixel_width = z / std::sqrt(view.camera.K(0, 0) * view.camera.K(1, 1));
  return TexturePoint{position, cv::normalize(from_camera.translation() - position),
                      static_cast<float>(key.size * pixel_width), 1};
}

}  // namespace

TextureKeypoints textureKeypoints(const TextureView& view, const TextureParams& params)
{
  check(view);
  TextureKeypoints found;
  const std::optional<ObjectPart> part = objectPart(view);
  if (!part) return found;
  KeypointParams keypoints;
  keypoints.detector = params.detector;
  keypoints.max_features = std::min(2 * params.view_features, kMaxFeatures);  // those beside the object are dropped
  const cv::Affine3d from_camera = view.pose.inv();
  const double side = std::max({part->gray.cols - 2 * kMargin, part->gray.rows - 2 * kMargin, 1});
  double scale = std::clamp(params.view_size / side, 1.0, kMaxEnlarging);
  for (int i = 0; i < params.scales; ++i, scale *= 0.5)
  {
    const Keypoints seen = keypointsAt(part->gray, scale, keypoints);
    int kept = 0;
    for (std::size_t j = 0; j < seen.all.size() && kept < params.view_features; ++j)
    {
      const std::optional<TexturePoint> point = pointOf(seen.all[j], *part, view, from_camera);
      if (!point) continue;
      found.points.push_back(*point);
      found.descriptors.push_back(seen.descriptors.row(static_cast<int>(j)));
      ++kept;
    }
  }
  return found;
}

}  // namespace robot_vision
