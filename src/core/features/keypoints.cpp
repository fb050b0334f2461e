#include "robot_vision/features/keypoints.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMinImageSide = 16;  // px; cv::ORB, cv::AKAZE and cv::MSER fail on images that are too small
constexpr int kRefineReach = 5;    // px from a corner to the side of the window that cornerSubPix looks at
const cv::TermCriteria kRefineEnd(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 0.001);

bool isCorner(const std::string& detector)
{
  return detector == "harris" || detector == "shi_tomasi";
}

/// Whether the detector has descriptors of its own.
bool describesItself(const std::string& detector)
{
  return detector == "orb" || detector == "sift" || detector == "akaze";
}

std::vector<cv::KeyPoint> findCorners(const cv::Mat& gray, const KeypointParams& p)
{
  const bool harris = p.detector == "harris";
  std::vector<cv::Point2f> corners;
  cv::goodFeaturesToTrack(gray, corners, p.max_features, p.corner_quality, p.corner_min_distance, cv::noArray(),
                          p.corner_block_size, harris, p.corner_harris_k);
  cv::Mat_<float> strength;
  if (harris)
    cv::cornerHarris(gray, strength, p.corner_block_size, 3, p.corner_harris_k);
  else
    cv::cornerMinEigenVal(gray, strength, p.corner_block_size, 3);
  std::vector<float> responses;
  for (const cv::Point2f& corner : corners)
    responses.push_back(strength(cv::Point(corner)));
  const int side = 2 * kRefineReach + 5;  // px, smallest that cornerSubPix takes
  if (p.corner_refine && !corners.empty() && std::min(gray.rows, gray.cols) >= side)
    cv::cornerSubPix(gray, corners, {kRefineReach, kRefineReach}, {-1, -1}, kRefineEnd);
  std::vector<cv::KeyPoint> keys;
  for (std::size_t i = 0; i < corners.size(); ++i)
    keys.emplace_back(corners[i], static_cast<float>(p.corner_block_size), -1.0F, responses[i]);
  return keys;
}

cv::Ptr<cv::Feature2D> makeFast(const KeypointParams& p)
{
  const auto type = p.fast_type == "type_5_8"    ? cv::FastFeatureDetector::TYPE_5_8
                    : p.fast_type == "type_7_12" ? cv::FastFeatureDetector::TYPE_7_12
                                                 : cv::FastFeatureDetector::TYPE_9_16;
  return cv::FastFeatureDetector::create(p.fast_threshold, p.fast_nonmax, type);
}

/// With as many levels as the image can be made smaller: cv::ORB fails if one has no pixel.
cv::Ptr<cv::Feature2D> makeOrb(const KeypointParams& p, const cv::Size& size)
{
  const double smallest = std::log(std::min(size.width, size.height)) / std::log(p.orb_scale_factor);
  const int levels = std::min(p.orb_levels, 1 + static_cast<int>(smallest));
  const auto score = p.orb_score == "fast" ? cv::ORB::FAST_SCORE : cv::ORB::HARRIS_SCORE;
  return cv::ORB::create(p.max_features, static_cast<float>(p.orb_scale_factor), levels, p.orb_patch_size, 0, 2, score,
                         p.orb_patch_size, p.orb_fast_threshold);
}

#if CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= 4)
constexpr bool kHasSift = true;

cv::Ptr<cv::Feature2D> makeSift(const KeypointParams& p)
{
  return cv::SIFT::create(p.max_features, p.sift_octave_layers, p.sift_contrast_threshold, p.sift_edge_threshold,
                          p.sift_sigma);
}
#else
constexpr bool kHasSift = false;

cv::Ptr<cv::Feature2D> makeSift(const KeypointParams& /*p*/)
{
  return {};  // validate() has refused it
}
#endif

cv::Ptr<cv::Feature2D> makeAkaze(const KeypointParams& p)
{
  return cv::AKAZE::create(cv::AKAZE::DESCRIPTOR_MLDB, 0, 3, static_cast<float>(p.akaze_threshold), p.akaze_octaves,
                           p.akaze_octave_layers);
}

cv::Ptr<cv::Feature2D> makeBlobs(const KeypointParams& p)
{
  cv::SimpleBlobDetector::Params blobs;
  blobs.filterByColor = p.blob_color != "any";
  blobs.blobColor = p.blob_color == "light" ? 255 : 0;
  blobs.minThreshold = static_cast<float>(p.blob_min_threshold);
  blobs.maxThreshold = static_cast<float>(p.blob_max_threshold);
  blobs.thresholdStep = static_cast<float>(p.blob_threshold_step);
  blobs.minRepeatability = static_cast<std::size_t>(p.blob_min_repeatability);
  blobs.minDistBetweenBlobs = static_cast<float>(p.blob_min_distance);
  blobs.filterByArea = true;
  blobs.minArea = static_cast<float>(p.blob_min_area);
  blobs.maxArea = static_cast<float>(p.blob_max_area);
  // Newer versions of OpenCV refuse a smallest share of 0 even where the filter is off.
  const auto filter = [](double least, bool& is_on, float& smallest)
  {
    is_on = least > 0.0;
    if (is_on) smallest = static_cast<float>(least);
  };
  filter(p.blob_min_circularity, blobs.filterByCircularity, blobs.minCircularity);
  filter(p.blob_min_convexity, blobs.filterByConvexity, blobs.minConvexity);
  filter(p.blob_min_inertia, blobs.filterByInertia, blobs.minInertiaRatio);
  return cv::SimpleBlobDetector::create(blobs);
}

cv::Ptr<cv::Feature2D> makeDetector(const KeypointParams& p, const cv::Size& size)
{
  if (p.detector == "fast") return makeFast(p);
  if (p.detector == "orb") return makeOrb(p, size);
  if (p.detector == "sift") return makeSift(p);
  if (p.detector == "akaze") return makeAkaze(p);
  if (p.detector == "mser")
    return cv::MSER::create(p.mser_delta, p.mser_min_area, p.mser_max_area, p.mser_max_variation);
  return makeBlobs(p);
}

/// The numbers of up to `count` keypoints, the strongest first. The order depends on nothing but the keypoints.
std::vector<std::size_t> strongestFirst(const std::vector<cv::KeyPoint>& keys, int count)
{
  const auto rank = [&keys](std::size_t i)
  {
    const cv::KeyPoint& key = keys[i];
    return std::make_tuple(-key.response, -key.size, key.pt.y, key.pt.x, key.angle, key.octave, i);
  };
  std::vector<std::size_t> order(keys.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::size_t kept = std::min(order.size(), static_cast<std::size_t>(count));
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(kept), order.end(),
                    [&rank](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  order.resize(kept);
  return order;
}

bool isFinite(const cv::KeyPoint& key)
{
  return std::isfinite(key.pt.x) && std::isfinite(key.pt.y) && std::isfinite(key.size) && std::isfinite(key.response);
}

/// Keeps the strongest keypoints, with the rows of their descriptors if there are any.
void keepStrongest(int count, std::vector<cv::KeyPoint>& keys, cv::Mat& descriptors)
{
  if (descriptors.empty())  // MSER's ellipse of a region that is a line may have no middle
    keys.erase(std::remove_if(keys.begin(), keys.end(), [](const cv::KeyPoint& key) { return !isFinite(key); }),
               keys.end());
  std::vector<cv::KeyPoint> kept;
  cv::Mat rows;
  for (const std::size_t i : strongestFirst(keys, count))
  {
    kept.push_back(keys[i]);
    if (!descriptors.empty()) rows.push_back(descriptors.row(static_cast<int>(i)));
  }
  keys = std::move(kept);
  descriptors = rows;
}

/// SIFT packs the layer and more into the octave, whose lowest byte is signed.
int octaveOf(const cv::KeyPoint& key, const std::string& detector)
{
  return detector == "sift" ? static_cast<signed char>(key.octave & 255) : key.octave;
}

}  // namespace

void validate(const KeypointParams& params)
{
  checkFields(params);
  require(params.detector != "sift" || kHasSift, "detector", "sift",
          std::string("another one: OpenCV has it since 4.4, and this is ") + CV_VERSION);
  require(params.mser_min_area <= params.mser_max_area, "mser_min_area", params.mser_min_area,
          "at most mser_max_area, " + toText(params.mser_max_area));
  require(params.blob_min_area < params.blob_max_area, "blob_min_area", params.blob_min_area,
          "below blob_max_area, " + toText(params.blob_max_area));
  const double span = params.blob_max_threshold - params.blob_min_threshold;
  require(span > 0.0, "blob_min_threshold", params.blob_min_threshold,
          "below blob_max_threshold, " + toText(params.blob_max_threshold));
  require(params.blob_threshold_step < span || params.blob_min_repeatability == 1, "blob_threshold_step",
          params.blob_threshold_step,
          "below blob_max_threshold - blob_min_threshold, " + toText(span) + ", or blob_min_repeatability 1");
}

Keypoints findKeypoints(const cv::Mat& image, const std::string& encoding, const KeypointParams& params, bool describe)
{
  validate(params);
  cv::Mat gray;
  toGray(image, encoding, gray);
  Keypoints found;
  if (std::min(gray.rows, gray.cols) < kMinImageSide) return found;
  const bool itself = describesItself(params.detector);
  if (isCorner(params.detector))
    found.all = findCorners(gray, params);
  else if (describe && itself)
    makeDetector(params, gray.size())->detectAndCompute(gray, cv::noArray(), found.all, found.descriptors);
  else
    makeDetector(params, gray.size())->detect(gray, found.all);
  keepStrongest(params.max_features, found.all, found.descriptors);
  std::vector<cv::KeyPoint> described;
  if (describe) described = found.all;
  if (describe && !itself) makeOrb(params, gray.size())->compute(gray, described, found.descriptors);
  cv::KeyPoint::convert(described, found.described);
  for (cv::KeyPoint& key : found.all)
    key.octave = octaveOf(key, params.detector);
  return found;
}

}  // namespace robot_vision
