#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "fit_kernels.hpp"
#include "robot_vision/recognition/view_model.hpp"

namespace robot_vision
{

/// The features of a view of one kind as points: where they are from its anchor, and their normals; of an edge that is
/// the direction across it, in the image.
class ViewPoints
{
public:
  ViewPoints() = default;
  ViewPoints(const View& view, const ViewModel& model, FeatureKind kind);

  int count() const { return count_; }
  FitPoints points() const;
  std::size_t memory() const { return numbers_.capacity() * sizeof(float); }

private:
  std::vector<float> numbers_;
  int count_ = 0;
};

/// Those of all kinds.
struct ViewFeatures
{
  ViewFeatures(const View& view, const ViewModel& model);

  std::size_t memory() const { return contours.memory() + inner.memory() + surfaces.memory(); }

  ViewPoints contours, inner, surfaces;
};

}  // namespace robot_vision
