#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct StereoParams
{
  std::string method = "sgbm_3way";
  int min_disparity = 0;
  int disparities = 64;
  int block_size = 5;
  int p1 = 0;
  int p2 = 0;
  int bm_block_size = 15;
  std::string prefilter = "xsobel";
  int prefilter_size = 9;
  int texture_threshold = 10;
  int prefilter_cap = 31;
  int uniqueness_ratio = 10;
  int disp12_max_diff = 1;
  int speckle_size = 100;
  double speckle_range = 1.0;
  int median = 0;
  bool full_image = true;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("method", &StereoParams::method, OneOf{"bm, sgbm, sgbm_3way or hh"}, "", "how disparities are found");
    visit("min_disparity", &StereoParams::min_disparity, Range{-512, 512}, "px", "of what is farthest away");
    visit("disparities", &StereoParams::disparities, Range{16, 512}, "px",
          "tried from min_disparity on, a multiple of 16; more see what is nearer, and take longer");
    visit("block_size", &StereoParams::block_size, OddRange{1, 11}, "px",
          "all but bm: side of the blocks that are compared; larger is smoother, and blurs borders");
    visit("p1", &StereoParams::p1, Range{0, 9000}, "",
          "all but bm: cost of a disparity that differs by 1 from its neighbour's; 0: 8 block_size^2");
    visit("p2", &StereoParams::p2, Range{0, 9000}, "",
          "all but bm: cost of a larger difference, above p1; 0: 32 block_size^2");
    visit("bm_block_size", &StereoParams::bm_block_size, OddRange{5, 99}, "px",
          "bm: side of the blocks that are compared");
    visit("prefilter", &StereoParams::prefilter, OneOf{"xsobel or normalized_response"}, "",
          "bm: what makes both images alike in brightness");
    visit("prefilter_size", &StereoParams::prefilter_size, OddRange{5, 89}, "px",
          "bm, normalized_response: side of the window that brightness is compared in");
    visit("texture_threshold", &StereoParams::texture_threshold, Range{0, 100000}, "",
          "bm: least sum of the prefiltered block's values");
    visit("prefilter_cap", &StereoParams::prefilter_cap, Range{1, 63}, "gray levels",
          "largest value of a prefiltered pixel");
    visit("uniqueness_ratio", &StereoParams::uniqueness_ratio, Range{0, 100}, "%",
          "by which the best disparity has to be better than others; more leaves out what is doubtful; sgbm_3way: less "
          "than 100, the less the larger block_size, prefilter_cap and p2 are");
    visit("disp12_max_diff", &StereoParams::disp12_max_diff, Range{-1, 512}, "px",
          "largest difference between the disparities of both images, at least 1 but with bm; -1: not compared");
    visit("speckle_size", &StereoParams::speckle_size, Range{0, 100000}, "px^2",
          "largest piece that is left out as it differs from all around; 0: none");
    visit("speckle_range", &StereoParams::speckle_range, Range{0, 64}, "px",
          "largest difference of two neighbours in one piece");
    visit("median", &StereoParams::median, OneOf{"0, 3 or 5"}, "px",
          "side of a median filter of the disparities; 0: none");
    visit("full_image", &StereoParams::full_image, Anything{}, "",
          "also find disparities near the borders, where OpenCV has none, in the time of a larger image");
  }
};

/// Throws std::invalid_argument for the first parameter out of range, for disparities that are no multiple of 16, for a
/// p2 that is not above p1, where 0 stands for its default, and for a uniqueness_ratio that is too large for sgbm_3way.
void validate(const StereoParams& params);

/// Finds how far what is seen in the left one of two rectified images is farther left in the right one.
///
/// The disparities are those of cv::StereoBM or cv::StereoSGBM (MODE_SGBM, MODE_SGBM_3WAY or MODE_HH), then filtered by
/// cv::medianBlur and cv::filterSpeckles. Without full_image they are equal to the bit. OpenCV looks only at pixels
/// that have a partner for every disparity that is tried, so that a strip at the left has none. With full_image the
/// images are widened by copies of their border pixels, and what is found in these copies is left out.
///
/// All is done in the thread of the caller. Not thread-safe.
class StereoMatcher
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit StereoMatcher(const StereoParams& params = StereoParams());
  ~StereoMatcher();

  const StereoParams& params() const;

  /// Writes the disparities of the left image's pixels into `disparity`, which is reused if it fits: CV_32FC1, px, x in
  /// the left image minus x in the right one, in steps of 1/16; NaN where none was found. `left_seen` and `right_seen`
  /// are 0 where a rectified image shows nothing, where there are none either (see Rectifier::seen(); CV_8UC1, empty:
  /// all is seen). The images are not modified. Throws std::invalid_argument if they are not of `encoding`, not of one
  /// size, smaller than 16 px or bm_block_size + 1 px, not wider than the largest disparity without full_image, less
  /// than twice as wide as min_disparity with bm, or with hh so large that they would take more than 1 GB.
  void match(const cv::Mat& left, const cv::Mat& right, const std::string& encoding, cv::Mat& disparity,
             const cv::Mat& left_seen = cv::Mat(), const cv::Mat& right_seen = cv::Mat());

  /// The part of a left image of this size that can have disparities; empty if none can.
  cv::Rect window(const cv::Size& size) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
