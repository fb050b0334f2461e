#include "texture_match.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "robot_vision/features/keypoints.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMaxEnlarging = 2.0;       // times, of a small image
constexpr int kNeighbors = 4;               // that are looked at for the next place that looks alike
constexpr double kPlaceRadius = 0.03;       // of the diameter: keypoints that are no farther apart are at one place
constexpr double kMaxBits = 0.3;            // share of the bits that may differ between descriptors that are alike
constexpr double kMaxDistance = 350.0;      // of two descriptors of sift, whose norm is 512
constexpr double kMaxToleranceScale = 3.0;  // of a keypoint's tolerance, for large ones

/// Whether a keypoint is in the mask.
bool isIn(const cv::Mat& mask, const cv::Point2f& point)
{
  const cv::Point pixel(std::clamp(cvRound(point.x), 0, mask.cols - 1), std::clamp(cvRound(point.y), 0, mask.rows - 1));
  return mask.at<uchar>(pixel) != 0;
}

void setDepth(const cv::Mat& metres, const DepthErrorParams& errors, TextureMatch& match)
{
  match.depth = NAN;
  const cv::Point pixel(cvRound(match.pixel.x), cvRound(match.pixel.y));
  if (metres.empty() || !cv::Rect({0, 0}, metres.size()).contains(pixel)) return;
  match.depth = metres.at<float>(pixel);
  match.depth_deviation = match.hasDepth() ? depthDeviation(match.depth, errors) : 0.0;
}

}  // namespace

ImageTexture textureOf(const SeenImage& image, const std::string& detector, const TextureMatchParams& params)
{
  KeypointParams keypoints;
  keypoints.detector = detector;
  keypoints.max_features = params.texture_features;
  const double wanted = static_cast<double>(params.texture_width) / image.gray.cols;
  const auto enlarged = static_cast<float>(std::clamp(wanted, 1.0, kMaxEnlarging));
  cv::Mat pixels = image.gray;
  if (enlarged > 1.0F) cv::resize(image.gray, pixels, {}, enlarged, enlarged, cv::INTER_LINEAR);
  const Keypoints found = findKeypoints(pixels, "mono8", keypoints, true);
  ImageTexture texture;
  for (std::size_t i = 0; i < found.all.size(); ++i)
  {
    cv::KeyPoint key = found.all[i];
    key.pt = {(key.pt.x + 0.5F) / enlarged - 0.5F, (key.pt.y + 0.5F) / enlarged - 0.5F};
    key.size /= enlarged;
    if (!image.mask.empty() && !isIn(image.mask, key.pt)) continue;
    texture.smallest = texture.keys.empty() ? key.size : std::min(texture.smallest, key.size);
    texture.keys.push_back(key);
    texture.descriptors.push_back(found.descriptors.row(static_cast<int>(i)));
  }
  return texture;
}

TextureIndex::TextureIndex(const TextureModel& model) : model_(model), index_(model.descriptors)
{
  model_.descriptors.release();  // the index has its own
}

std::vector<TextureIndex::IndexPair> TextureIndex::pairs(const ImageTexture& texture, double ratio)
{
  const bool is_float = texture.descriptors.depth() == CV_32F;
  const double limit = is_float ? kMaxDistance : kMaxBits * 8.0 * texture.descriptors.cols;
  const double place = kPlaceRadius * model_.extent.diameter;
  const auto positionOf = [&](const cv::DMatch& match)
  { return model_.points[static_cast<std::size_t>(match.trainIdx)].position; };
  std::vector<IndexPair> pairs;
  for (const std::vector<cv::DMatch>& of_key : index_.nearest(texture.descriptors, kNeighbors))
  {
    if (of_key.empty() || of_key[0].distance > limit) continue;
    double next = of_key.size() < kNeighbors ? limit : of_key.back().distance;  // if all of them are at one place
    for (const cv::DMatch& other : of_key)
      if (cv::norm(positionOf(other) - positionOf(of_key[0])) > place)
      {
        next = other.distance;
        break;
      }
    if (of_key[0].distance <= ratio * next) pairs.push_back({of_key[0].queryIdx, of_key[0].trainIdx});
  }
  return pairs;
}

std::vector<TextureMatch> TextureIndex::match(const SeenImage& image, const ImageTexture& texture,
                                              const TextureMatchParams& params, const DepthErrorParams& errors)
{
  const double focal = image.focal();
  std::vector<TextureMatch> matches;
  for (const IndexPair& pair : pairs(texture, params.texture_ratio))
  {
    const cv::KeyPoint& key = texture.keys[static_cast<std::size_t>(pair.key)];
    const TexturePoint& point = model_.points[static_cast<std::size_t>(pair.point)];
    TextureMatch match;
    match.pixel = key.pt;
    match.ray = image.camera->ray(key.pt);
    if (!std::isfinite(match.ray.x) || !std::isfinite(match.ray.y)) continue;
    const double scale = std::min<double>(key.size / texture.smallest, kMaxToleranceScale);
    match.tolerance = params.texture_error * scale / focal;
    match.distance = point.size * focal / key.size;
    match.point = point.position;
    match.direction = point.direction;
    setDepth(image.metres, errors, match);
    matches.push_back(match);
  }
  return matches;
}

}  // namespace robot_vision
