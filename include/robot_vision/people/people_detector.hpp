#pragma once

#include <opencv2/core.hpp>
#include <opencv2/objdetect.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct PeopleParams
{
  std::string model = "default";
  double hit_threshold = 0.0;
  int win_stride = 8;
  int padding = 8;
  double scale = 1.05;
  double group_threshold = 2.0;
  bool mean_shift = false;
  int max_width = 400;
  int min_height = 0;
  int max_people = 50;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("model", &PeopleParams::model, OneOf{"default or daimler"}, "",
          "of OpenCV: default has a window of 64x128 px, daimler one of 48x96 px");
    visit("hit_threshold", &PeopleParams::hit_threshold, Range{-1, 10}, "",
          "distance from the plane of the support vector machine above which a window has a person");
    visit("win_stride", &PeopleParams::win_stride, Range{4, 64}, "px",
          "from one window to the next, in the image of each size; the nearest multiple of 4 is taken");
    visit("padding", &PeopleParams::padding, Range{0, 64}, "px",
          "around the image of each size, for people whom its edges cut");
    visit("scale", &PeopleParams::scale, Range{1.01, 2}, "", "from one size that is searched to the next");
    visit("group_threshold", &PeopleParams::group_threshold, Range{0, 100}, "",
          "windows that must agree on a person besides the first; 0: each window is one; mean_shift: least density");
    visit("mean_shift", &PeopleParams::mean_shift, Anything{}, "",
          "group windows by the densest places, not by overlap");
    visit("max_width", &PeopleParams::max_width, Range{64, 8192}, "px",
          "wider images are shrunk to this first, but not below one and a half windows");
    visit("min_height", &PeopleParams::min_height, Range{0, 8192}, "px",
          "lowest window in the whole image; larger ones are searched faster");
    visit("max_people", &PeopleParams::max_people, Range{1, 1000}, "", "so many are reported, the surest ones");
  }
};

/// A person in an image.
struct Person
{
  cv::Rect box;         // px, the detector's window, which is somewhat larger than the person; inside of the image
  double weight = 0.0;  // distance from the plane of the support vector machine; with mean_shift the windows' density
  double score = 0.0;   // 1 / (1 + exp(-weight)): 0 to 1, without mean_shift 0.5 on the plane
};

/// Finds people who stand or walk upright by histograms of oriented gradients and a support vector machine (Dalal,
/// Triggs: Histograms of Oriented Gradients for Human Detection, CVPR 2005): as cv::HOGDescriptor::detectMultiScale
/// with the models that OpenCV brings, on the image shrunk to max_width, or to one and a half windows if it would be
/// smaller then. Of more than 1000 windows that hit the surest 1000 are grouped. Threads may share one, because it
/// never changes.
class PeopleDetector
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit PeopleDetector(const PeopleParams& params = PeopleParams());

  /// The people in an image, the surest first. Throws std::invalid_argument if `image` is not an image of `encoding`
  /// (see encoding.hpp), and if the search would take many seconds.
  std::vector<Person> detect(const cv::Mat& image, const std::string& encoding) const;

private:
  double scaleOf(const cv::Size& image) const;

  PeopleParams params_;
  cv::HOGDescriptor hog_;
};

}  // namespace robot_vision
