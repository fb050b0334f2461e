#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "look_kernels.hpp"
#include "robot_vision/recognition/symmetry.hpp"
#include "robot_vision/recognition/view_model.hpp"
#include "search_kernels.hpp"

namespace robot_vision
{

constexpr int kCells = 12;  // of a row of those around a place

/// A view with one of its turns about the line of sight.
struct Template
{
  int view = 0;
  double turn = 0.0;  // rad
};

/// The codes of templates: kCodeFeatures numbers of planes each, see SearchKernels.
struct TemplateCodes
{
  std::vector<Template> templates;
  std::vector<std::uint16_t> features;

  const std::uint16_t* code(std::size_t i) const { return features.data() + i * kCodeFeatures; }
};

/// The templates of a model, coarse ones and those between them, as codes for cells of a given size.
class ViewTemplates
{
public:
  /// `half_width` (m) is that of all cells around a place. Without `with_depth` only edges count.
  ViewTemplates(const ViewModel& model, double half_width, bool with_depth);

  /// How far (m) any feature is from the anchor of its view, across the line of sight.
  static double reachOf(const ViewModel& model);

  /// The coarse ones, and for each the finer ones that look most like it: those from children(i) to children(i + 1).
  const TemplateCodes& coarse() const { return coarse_; }
  const TemplateCodes& fine() const { return fine_; }
  std::size_t children(std::size_t i) const { return children_[i]; }

  /// Where the features of the codes of a view are, in the frame of the view.
  LookPoints points(int view) const
  {
    const float* const x = points_.data() + static_cast<std::size_t>(view) * 3 * kCodeFeatures;
    return {x, x + kCodeFeatures, x + 2 * kCodeFeatures};
  }

  std::size_t memory() const;

private:
  TemplateCodes coarse_, fine_;
  std::vector<std::size_t> children_;
  std::vector<float> points_;
};

/// The turn about the axis of the camera, from x to y.
cv::Matx33d turnInImage(double angle);

}  // namespace robot_vision
