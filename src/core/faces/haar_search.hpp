#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "placed_cascade.hpp"

namespace robot_vision
{

/// Searches images with a cascade: the same windows as cv::CascadeClassifier, some times as fast, in the thread of the
/// caller alone. For one thread at a time, as it keeps what it works with.
class HaarSearch
{
public:
  explicit HaarSearch(std::shared_ptr<const HaarCascade> cascade);

  /// All windows in which the cascade sees what it is for, in an image (CV_8UC1) that is scaled down by each of the
  /// factors (1 or more, the first one the smallest). These are the windows of one call of detectMultiScale for these
  /// factors, which are not grouped, and as they are rounded may stick out. Ends early, with none, when `stop` (may be
  /// null) is true.
  std::vector<cv::Rect> find(const cv::Mat& gray, const std::vector<double>& factors,
                             const std::atomic<bool>* stop = nullptr);

  const HaarCascade& cascade() const { return *cascade_; }

private:
  /// Some rows of the integral images.
  struct Band
  {
    const HaarLayout& layout;
    const std::int32_t* sums;
    const std::int32_t* squares;
  };

  void integrate(const HaarLayout& layout);
  void findAtScale(const cv::Mat& gray, float scale, int stripes, std::vector<cv::Rect>& found);
  int look(const PlacedCascade& placed, int first_row, const cv::Size& windows);
  int list(const PlacedCascade& placed, const Band& band, const cv::Size& windows);
  int visit(const Band& band, int first, int count, int listed);
  double votes(const Band& band, const HaarStage& stage, std::int32_t window) const;
  bool passes(const Band& band, std::int32_t window) const;

  std::shared_ptr<const HaarCascade> cascade_;
  PlacedCascade whole_, split_;  // for every column, and for every other one
  cv::Mat scaled_;
  std::vector<std::int32_t> sums_, squares_;  // integral images
  std::vector<float> factors_;                // of a band's windows, see HaarKernels
  std::vector<std::uint8_t> verdicts_;        // on these windows
  std::vector<std::int32_t> windows_;         // indices of those that are left
};

}  // namespace robot_vision
