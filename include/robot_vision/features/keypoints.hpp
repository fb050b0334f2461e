#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct KeypointParams
{
  std::string detector = "orb";
  int max_features = 1000;
  double corner_quality = 0.01;
  double corner_min_distance = 10.0;
  int corner_block_size = 3;
  double corner_harris_k = 0.04;
  bool corner_refine = false;
  int fast_threshold = 10;
  bool fast_nonmax = true;
  std::string fast_type = "type_9_16";
  double orb_scale_factor = 1.2;
  int orb_levels = 8;
  int orb_patch_size = 31;
  int orb_fast_threshold = 20;
  std::string orb_score = "harris";
  int sift_octave_layers = 3;
  double sift_contrast_threshold = 0.04;
  double sift_edge_threshold = 10.0;
  double sift_sigma = 1.6;
  double akaze_threshold = 0.001;
  int akaze_octaves = 4;
  int akaze_octave_layers = 4;
  int mser_delta = 5;
  int mser_min_area = 60;
  int mser_max_area = 14400;
  double mser_max_variation = 0.25;
  std::string blob_color = "dark";
  double blob_min_threshold = 50.0;
  double blob_max_threshold = 220.0;
  double blob_threshold_step = 10.0;
  int blob_min_repeatability = 2;
  double blob_min_distance = 10.0;
  double blob_min_area = 25.0;
  double blob_max_area = 5000.0;
  double blob_min_circularity = 0.0;
  double blob_min_convexity = 0.95;
  double blob_min_inertia = 0.1;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("detector", &KeypointParams::detector, OneOf{"harris, shi_tomasi, fast, orb, sift, akaze, mser or blobs"}, "",
          "what looks for keypoints");
    visit("max_features", &KeypointParams::max_features, Range{1, 5000}, "",
          "most keypoints, the strongest; of mser and blobs the largest");
    visit("corner_quality", &KeypointParams::corner_quality, Above{0, 1}, "",
          "harris, shi_tomasi: weakest corner, as a share of the strongest");
    visit("corner_min_distance", &KeypointParams::corner_min_distance, Range{0, 1000}, "px",
          "harris, shi_tomasi: least distance between two corners");
    visit("corner_block_size", &KeypointParams::corner_block_size, Range{2, 31}, "px",
          "harris, shi_tomasi: side of the window around a corner");
    visit("corner_harris_k", &KeypointParams::corner_harris_k, Range{0, 0.25}, "",
          "harris: weight of the trace, against edges");
    visit("corner_refine", &KeypointParams::corner_refine, Anything{}, "",
          "harris, shi_tomasi: move corners to where the gradients meet, by cornerSubPix");
    visit("fast_threshold", &KeypointParams::fast_threshold, Range{1, 255}, "gray levels",
          "fast: difference between a corner and the circle around it");
    visit("fast_nonmax", &KeypointParams::fast_nonmax, Anything{}, "", "fast: only the strongest of neighbours");
    visit("fast_type", &KeypointParams::fast_type, OneOf{"type_5_8, type_7_12 or type_9_16"}, "",
          "fast: pixels in a row that must differ, of how many");
    visit("orb_scale_factor", &KeypointParams::orb_scale_factor, Range{1.05, 2}, "",
          "orb: factor between two levels of the pyramid");
    visit("orb_levels", &KeypointParams::orb_levels, Range{1, 16}, "", "orb: levels of the pyramid");
    visit("orb_patch_size", &KeypointParams::orb_patch_size, Range{9, 99}, "px",
          "orb: side of what is described, and width of the border without keypoints");
    visit("orb_fast_threshold", &KeypointParams::orb_fast_threshold, Range{1, 255}, "gray levels",
          "orb: difference between a corner and the circle around it");
    visit("orb_score", &KeypointParams::orb_score, OneOf{"harris or fast"}, "", "orb: response of a keypoint");
    visit("sift_octave_layers", &KeypointParams::sift_octave_layers, Range{1, 10}, "", "sift: scales in an octave");
    visit("sift_contrast_threshold", &KeypointParams::sift_contrast_threshold, Range{0, 1}, "",
          "sift: weakest contrast, of an image from 0 to 1");
    visit("sift_edge_threshold", &KeypointParams::sift_edge_threshold, Range{1, 100}, "",
          "sift: most that a keypoint may be like an edge");
    visit("sift_sigma", &KeypointParams::sift_sigma, Range{0.5, 5}, "px", "sift: blur of the first scale");
    visit("akaze_threshold", &KeypointParams::akaze_threshold, Range{1e-6, 1}, "", "akaze: weakest response");
    visit("akaze_octaves", &KeypointParams::akaze_octaves, Range{1, 8}, "", "akaze: halvings of the image");
    visit("akaze_octave_layers", &KeypointParams::akaze_octave_layers, Range{1, 10}, "", "akaze: scales in an octave");
    visit("mser_delta", &KeypointParams::mser_delta, Range{1, 100}, "gray levels",
          "mser: threshold's change over which a region is stable");
    visit("mser_min_area", &KeypointParams::mser_min_area, Range{10, 1e6}, "px^2", "mser: smallest region");
    visit("mser_max_area", &KeypointParams::mser_max_area, Range{10, 1e6}, "px^2", "mser: largest region");
    visit("mser_max_variation", &KeypointParams::mser_max_variation, Range{0.01, 2}, "",
          "mser: most growth over mser_delta, as a share of the area");
    visit("blob_color", &KeypointParams::blob_color, OneOf{"dark, light or any"}, "",
          "blobs: gray of the middle of a blob");
    visit("blob_min_threshold", &KeypointParams::blob_min_threshold, Range{0, 255}, "gray levels",
          "blobs: first threshold");
    visit("blob_max_threshold", &KeypointParams::blob_max_threshold, Range{0, 255}, "gray levels",
          "blobs: end of the thresholds");
    visit("blob_threshold_step", &KeypointParams::blob_threshold_step, Range{5, 255}, "gray levels",
          "blobs: between two thresholds");
    visit("blob_min_repeatability", &KeypointParams::blob_min_repeatability, Range{1, 255}, "",
          "blobs: fewest thresholds at which a blob is there");
    visit("blob_min_distance", &KeypointParams::blob_min_distance, Range{0.1, 1000}, "px",
          "blobs: least distance between the centres of two blobs");
    visit("blob_min_area", &KeypointParams::blob_min_area, Range{10, 1e7}, "px^2", "blobs: smallest blob");
    visit("blob_max_area", &KeypointParams::blob_max_area, Range{10, 1e7}, "px^2", "blobs: largest blob");
    visit("blob_min_circularity", &KeypointParams::blob_min_circularity, Range{0, 1}, "",
          "blobs: least 4 pi area / perimeter^2, 1 for a circle; 0: any");
    visit("blob_min_convexity", &KeypointParams::blob_min_convexity, Range{0, 1}, "",
          "blobs: least share of its hull that a blob fills; 0: any");
    visit("blob_min_inertia", &KeypointParams::blob_min_inertia, Range{0, 1}, "",
          "blobs: least ratio of the inertias, small for a line, 1 for a circle; 0: any");
  }
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and its range, and for sift if this
/// OpenCV has none.
void validate(const KeypointParams& params);

/// Keypoints of an image, the strongest first.
struct Keypoints
{
  std::vector<cv::KeyPoint> all;       // px; angle in degrees, -1: none; octave of the pyramid, 0: the full image
  cv::Mat descriptors;                 // a row for each point below: CV_8U, or CV_32F of sift; empty if not asked for
  std::vector<cv::Point2f> described;  // px, of those whose surroundings are in the image
};

/// Finds keypoints as OpenCV does: cv::goodFeaturesToTrack (harris, shi_tomasi), cv::FastFeatureDetector, cv::ORB,
/// cv::SIFT, cv::AKAZE, cv::MSER or cv::SimpleBlobDetector, each in the image's gray. Corners have the response that
/// they were chosen by. Those of equal response are in the order of size, then of rows. An image too small for the
/// detector has none.
///
/// With `describe` those that can be are described: orb, sift and akaze by themselves, all others by cv::ORB, at their
/// place in the full image and as upright.
///
/// Throws std::invalid_argument as validate() does, and if `image` is not of `encoding` (see encoding.hpp).
Keypoints findKeypoints(const cv::Mat& image, const std::string& encoding,
                        const KeypointParams& params = KeypointParams(), bool describe = false);

}  // namespace robot_vision
