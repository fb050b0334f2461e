#include "robot_vision/stereo/stereo_matcher.hpp"

#include <algorithm>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/common/in_this_thread.hpp"
#include "core/image/conversion_buffer.hpp"
#include "fixed_disparities.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMinSide = 16;                    // px
constexpr int kUnlimited = 1 << 20;             // px, a difference that no two disparities have
constexpr double kMaxCosts = 1 << 28;           // of hh, which takes 4 bytes for each disparity of each pixel
constexpr int kMultiple = 16;                   // px, of the number of disparities
constexpr int kSmallStep = 8, kLargeStep = 32;  // costs for each pixel of a block, as in OpenCV's samples
constexpr int kMinCap = 15;                     // gray levels, SGBM's prefilter has no smaller one
constexpr int kMaxGrayCost = 255 / 4;           // of a pixel's gray value, beside that of its prefiltered one
constexpr double kMaxCost = 32766.0;            // that SGBM can compare, with 16 bits

bool isBm(const StereoParams& params)
{
  return params.method == "bm";
}

int costOf(int given, int per_pixel, int block_size)
{
  return given > 0 ? given : per_pixel * block_size * block_size;
}

cv::Ptr<cv::StereoMatcher> makeBm(const StereoParams& p)
{
  const auto bm = cv::StereoBM::create(p.disparities, p.bm_block_size);
  bm->setMinDisparity(p.min_disparity);
  bm->setPreFilterType(p.prefilter == "xsobel" ? cv::StereoBM::PREFILTER_XSOBEL
                                               : cv::StereoBM::PREFILTER_NORMALIZED_RESPONSE);
  bm->setPreFilterSize(p.prefilter_size);
  bm->setPreFilterCap(p.prefilter_cap);
  bm->setTextureThreshold(p.texture_threshold);
  bm->setUniquenessRatio(p.uniqueness_ratio);
  bm->setDisp12MaxDiff(p.disp12_max_diff);
  return bm;
}

cv::Ptr<cv::StereoMatcher> makeSgbm(const StereoParams& p)
{
  static const std::map<std::string, int> modes = {{"sgbm", cv::StereoSGBM::MODE_SGBM},
                                                   {"sgbm_3way", cv::StereoSGBM::MODE_SGBM_3WAY},
                                                   {"hh", cv::StereoSGBM::MODE_HH}};
  // SGBM takes a difference of 0 or less for 1, other than its documentation says.
  const int max_difference = p.disp12_max_diff < 0 ? kUnlimited : std::max(1, p.disp12_max_diff);
  return cv::StereoSGBM::create(p.min_disparity, p.disparities, p.block_size, costOf(p.p1, kSmallStep, p.block_size),
                                costOf(p.p2, kLargeStep, p.block_size), max_difference, p.prefilter_cap,
                                p.uniqueness_ratio, 0, 0, modes.at(p.method));
}

/// The largest ratio with which sgbm_3way leaves out what is doubtful.
///
/// OpenCV divides the least cost by 1 - ratio, and keeps 16 bits of that: a cost that is too large for them becomes one
/// that nothing is below, so that all disparities are taken for certain, and 100 % ends the process. The least cost is
/// the sum of three directions. Even of images that have nothing to do with each other it is mostly less than one
/// direction's largest cost, which is what counts here.
int maxUniquenessRatio(const StereoParams& p)
{
  const int max_of_pixel = 2 * (std::max(p.prefilter_cap, kMinCap) | 1) + kMaxGrayCost;
  const int max_cost = max_of_pixel * p.block_size * p.block_size + costOf(p.p2, kLargeStep, p.block_size);
  return std::max(0, static_cast<int>(100.0 * (1.0 - max_cost / kMaxCost)));
}

/// What both images are widened by, px.
struct Margins
{
  int left = 0;
  int right = 0;
  int rows = 0;  // above and below
};

Margins marginsOf(const StereoParams& p)
{
  if (!p.full_image) return {};
  const int half = isBm(p) ? p.bm_block_size / 2 : 0;
  return {std::max(0, p.min_disparity + p.disparities) + half, std::max(0, -p.min_disparity) + half, half};
}

cv::Mat widened(const cv::Mat& gray, const Margins& by)
{
  if (by.left + by.right + by.rows == 0) return gray;
  cv::Mat wide;
  cv::copyMakeBorder(gray, wide, by.rows, by.rows, by.left, by.right, cv::BORDER_REPLICATE);
  return wide;
}

}  // namespace

void validate(const StereoParams& params)
{
  checkFields(params);
  require(params.disparities % kMultiple == 0, "disparities", params.disparities, "a multiple of 16");
  const int p1 = costOf(params.p1, kSmallStep, params.block_size);
  const int p2 = costOf(params.p2, kLargeStep, params.block_size);
  require(p2 > p1, "p2", p2, "above p1, " + std::to_string(p1));
  const int max_ratio = maxUniquenessRatio(params);
  require(params.method != "sgbm_3way" || params.uniqueness_ratio <= max_ratio, "uniqueness_ratio",
          params.uniqueness_ratio,
          "at most " + std::to_string(max_ratio) + " for sgbm_3way with these block_size, prefilter_cap and p2");
}

struct StereoMatcher::Impl
{
  explicit Impl(const StereoParams& p) : params(p), matcher(isBm(p) ? makeBm(p) : makeSgbm(p)), margins(marginsOf(p)) {}

  void match(const cv::Mat& left, const cv::Mat& right, const std::string& encoding)
  {
    const cv::Mat of_left = left_buffer.gray(left, encoding), of_right = right_buffer.gray(right, encoding);
    require(of_left.size() == of_right.size(), "the right image's size", toText(of_right.size()),
            toText(of_left.size()) + " as of the left one");
    requireMatchable(of_left.size());
    const cv::Mat left_wide = widened(of_left, margins), right_wide = widened(of_right, margins);
    if (isBm(params))  // which writes nothing at all if blocks and disparities leave no pixel that can be matched
    {
      wide.create(left_wide.size(), CV_16SC1);
      wide.setTo(invalidDisparity(params.min_disparity));
    }
    matcher->compute(left_wide, right_wide, wide);
    const cv::Mat inner = wide(cv::Rect({margins.left, margins.rows}, of_left.size()));
    if (params.median > 0)
      cv::medianBlur(inner, found, params.median);
    else
      inner.copyTo(found);
  }

  void requireMatchable(const cv::Size& size) const
  {
    const int window = params.prefilter == "normalized_response" ? params.prefilter_size / 2 : 0;
    const int smallest = isBm(params) ? std::max({kMinSide, params.bm_block_size + 1, window}) : kMinSide;
    require(std::min(size.width, size.height) >= smallest, "the images' size", toText(size),
            "at least " + std::to_string(smallest) + " px wide and high");
    const int reach = std::max(0, params.min_disparity + params.disparities) + std::max(0, -params.min_disparity);
    require(params.full_image || size.width > reach, "the images' width", size.width,
            "above " + std::to_string(reach) + " px, what disparities from min_disparity on need without full_image");
    // With blocks of 5 px and a prefilter_cap above 31 StereoBM writes costs behind the end of its memory if
    // min_disparity is more than half of the width.
    const int wide_enough = 2 * params.min_disparity - margins.left - margins.right;
    require(!isBm(params) || size.width >= wide_enough, "the images' width", size.width,
            "at least " + std::to_string(wide_enough) + " px for bm with so large a min_disparity");
    const double costs = 1.0 * (size.width + margins.left + margins.right) * size.height * params.disparities;
    require(params.method != "hh" || costs <= kMaxCosts, "the images' size", toText(size),
            "smaller for hh with so many disparities, which would take more than 1 GB");
  }

  /// Leaves out what has its partner where there is no image.
  void filter(const cv::Mat& left_seen, const cv::Mat& right_seen)
  {
    const int invalid = invalidDisparity(params.min_disparity);
    dropUnseen(found, invalid, left_seen, right_seen);
    if (params.speckle_size > 0)
      cv::filterSpeckles(found, invalid, params.speckle_size, cvRound(kDisparitySteps * params.speckle_range),
                         speckle_buffer);
  }

  StereoParams params;
  cv::Ptr<cv::StereoMatcher> matcher;
  Margins margins;
  ConversionBuffer left_buffer, right_buffer;
  cv::Mat wide, found;  // CV_16SC1, of the widened images and of the images
  cv::Mat speckle_buffer;
};

StereoMatcher::StereoMatcher(const StereoParams& params)
{
  validate(params);
  impl_ = std::make_unique<Impl>(params);
}

StereoMatcher::~StereoMatcher() = default;

const StereoParams& StereoMatcher::params() const
{
  return impl_->params;
}

void StereoMatcher::match(const cv::Mat& left, const cv::Mat& right, const std::string& encoding, cv::Mat& disparity,
                          const cv::Mat& left_seen, const cv::Mat& right_seen)
{
  inThisThread(
      [&]
      {
        impl_->match(left, right, encoding);
        impl_->filter(left_seen, right_seen);
      });
  toPixels(impl_->found, invalidDisparity(impl_->params.min_disparity), disparity);
}

cv::Rect StereoMatcher::window(const cv::Size& size) const
{
  const StereoParams& p = impl_->params;
  const int lowest = p.min_disparity, highest = p.min_disparity + p.disparities - 1;
  const int half = isBm(p) && !p.full_image ? p.bm_block_size / 2 : 0;
  const int begin = (p.full_image ? std::max(0, lowest) : std::max(0, isBm(p) ? highest : highest + 1)) + half;
  const int end = std::min(size.width + std::min(0, p.full_image ? highest : lowest), size.width - half);
  if (begin >= end || size.height <= 2 * half) return {};
  return {begin, half, end - begin, size.height - 2 * half};
}

}  // namespace robot_vision
