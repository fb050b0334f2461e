#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct TemplateParams
{
  std::string method = "ccoeff_normed";
  bool color = false;
  std::string results = "single";
  double threshold = 0.8;
  int max_results = 20;
  double overlap = 0.3;
  double min_scale = 1.0;
  double max_scale = 1.0;
  int scale_steps = 1;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("method", &TemplateParams::method,
          OneOf{"sqdiff, sqdiff_normed, ccorr, ccorr_normed, ccoeff or ccoeff_normed"}, "",
          "how a template is compared with the image");
    visit("color", &TemplateParams::color, Anything{}, "", "compare colours instead of gray");
    visit("results", &TemplateParams::results, OneOf{"single or multiple"}, "", "of each template in an image");
    visit("threshold", &TemplateParams::threshold, Range{0, 1}, "", "least score of a result");
    visit("max_results", &TemplateParams::max_results, Range{1, 1000}, "", "multiple: most results, the best");
    visit("overlap", &TemplateParams::overlap, Range{0, 1}, "",
          "common share of two boxes (IoU) above which the worse is left out");
    visit("min_scale", &TemplateParams::min_scale, Range{0.1, 10}, "", "smallest size of a template, of its own");
    visit("max_scale", &TemplateParams::max_scale, Range{0.1, 10}, "", "largest size, min_scale or more");
    visit("scale_steps", &TemplateParams::scale_steps, Range{1, 50}, "",
          "sizes between them, each larger than the last by the same factor; 1: only min_scale");
  }
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and its range.
void validate(const TemplateParams& params);

/// Compares a template with every place of an image, as cv::matchTemplate does: CV_32FC1, an element for each place of
/// the template's top left pixel. Image and template are both CV_8UC1 or both CV_8UC3; `mask` (CV_8UC1, not 0 for the
/// pixels that count, of the template's size) may be empty. No element is NaN or infinite: with a mask, where the image
/// has no contrast (ccoeff_normed) or is black (ccorr_normed, sqdiff_normed) OpenCV divides by zero, and there the
/// response is the worst, 0 or 1. Throws std::invalid_argument if sizes or types do not fit, if the method is unknown,
/// and for a mask if this OpenCV takes none with the method, as 4.2 does only with sqdiff and ccorr_normed.
cv::Mat templateResponse(const cv::Mat& image, const cv::Mat& templ, const cv::Mat& mask, const std::string& method);

/// A response as an image to look at, CV_8UC1: 255 at the best place, 0 at the worst; all 0 if all are alike.
cv::Mat responseImage(const cv::Mat& response, const std::string& method);

/// A place where a template is.
struct TemplateMatch
{
  int index = 0;       // of the template, in the order in which they were added
  double score = 0.0;  // 0 to 1, see TemplateMatcher
  double scale = 1.0;  // of the template
  cv::Rect box;        // px
  cv::Point2d center;  // px, sub-pixel: from a parabola through the best response and its neighbours
};

struct TemplateMatches
{
  std::vector<TemplateMatch> matches;  // the best first
  cv::Mat response;                    // of templateResponse(), if wanted: of the template and scale that fit best
  std::vector<int> too_large;          // templates that are larger than the image in every scale
};

/// Looks for templates at several scales in images.
///
/// The score is 0 to 1 with every method: of the normed ones the response (1 minus it of sqdiff_normed), not below 0;
/// of sqdiff 1 minus the root of the mean squared difference, white against black being 1; of ccorr and ccoeff the
/// response as a share of the largest that this template can have in any image. Matches are the best places, for
/// `single` the best of each template, that share no more than `overlap` with a better one: of two templates with the
/// same best place only one has a match.
///
/// Threads may share one: they match at the same time, and wait while a template is added.
class TemplateMatcher
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit TemplateMatcher(const TemplateParams& params = TemplateParams());
  ~TemplateMatcher();

  /// Adds a template, and returns its index. Of `mask` (CV_8UC1, of the image's size; empty: none) pixels from 128 on
  /// count. Throws std::invalid_argument if `image` is not of `encoding`, if the mask leaves nothing or is not taken by
  /// this OpenCV, if the template has no contrast (ccoeff, ccoeff_normed) or is black (all but sqdiff) in every scale,
  /// and if all templates in all scales would be more than 200, or have more than 64 million pixels.
  int add(const cv::Mat& image, const std::string& encoding, const cv::Mat& mask = cv::Mat());

  /// Finds the templates in an image, which is not modified. Throws std::invalid_argument if it is not of `encoding`,
  /// and if it is so large that all templates in all scales would take many seconds: if its pixels in each channel, for
  /// each template and scale, are more than 64 million.
  TemplateMatches match(const cv::Mat& image, const std::string& encoding, bool wants_response = false) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
