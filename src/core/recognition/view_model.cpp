#include "robot_vision/recognition/view_model.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "robot_vision/common/range.hpp"
#include "robot_vision/recognition/view_tree.hpp"

namespace robot_vision
{
namespace
{

constexpr double kFullTurn = 2.0 * CV_PI;
constexpr double kMaxLength = 1e4;  // m
constexpr int kMaxSteps = 17000;    // of a place: twice the radius, and a margin
constexpr int kHalfTurn = 128;      // of the direction across an edge
constexpr int kUnit = 127;          // of the length of a normal

template <int n>
bool isWithin(const cv::Vec<double, n>& numbers, double limit)
{
  return std::all_of(numbers.val, numbers.val + n, [&](double number) { return std::abs(number) <= limit; });
}

bool isPossible(const ViewFeature& feature)
{
  const int farthest = std::max({std::abs(int{feature.x}), std::abs(int{feature.y}), std::abs(int{feature.z})});
  if (farthest > kMaxSteps) return false;
  if (feature.kind == FeatureKind::kSurface) return feature.a * feature.a + feature.b * feature.b <= kUnit * kUnit;
  return feature.kind <= FeatureKind::kSurface && feature.a >= 0 && feature.a < kHalfTurn && feature.b == 0;
}

/// What is wrong with a view; empty: nothing.
const char* faultOf(const View& view, int index, const ViewModel& model)
{
  const double limit = 2.0 * model.extent.radius * 1.001;
  if (!isWithin(view.rotation, kFullTurn)) return "a rotation of at most a full turn";
  if (!isWithin(view.center, limit)) return "the object's middle within its diameter";
  if (!isWithin(cv::Vec4d(view.box.x, view.box.y, view.box.width, view.box.height), 4.0 * limit))
    return "a box around the object";
  if (!(view.spin >= 0.0 && view.spin <= kFullTurn * 1.001)) return "turns of at most a full one";
  const int coarsest = model.levels.front();
  if (index < coarsest ? view.parent != -1 : view.parent < 0 || view.parent >= index) return "a parent before it";
  if (view.features.size() > 1000) return "at most 1000 features";
  if (!std::all_of(view.features.begin(), view.features.end(), isPossible)) return "features of the object";
  return "";
}

void checkExtent(const MeshExtent& extent)
{
  require(isWithin(extent.center, kMaxLength) && isWithin(extent.size, kMaxLength), "the extent of a model's mesh",
          "not a number, or beyond 10 km", "finite");
  require(extent.radius > 0.0 && extent.radius <= kMaxLength, "the radius of a model", extent.radius, "above 0");
  require(extent.diameter > 0.0 && extent.diameter <= 2.001 * extent.radius, "the diameter of a model", extent.diameter,
          "above 0, and at most twice its radius");
}

}  // namespace

std::size_t ViewModel::templates() const
{
  std::size_t count = 0;
  for (const View& view : views)
    count += static_cast<std::size_t>(turnsOf(view, params));
  return count;
}

std::size_t ViewModel::memory() const
{
  std::size_t bytes = sizeof *this + symmetries.capacity() * sizeof(Symmetry) + levels.capacity() * sizeof(int) +
                      views.capacity() * sizeof(View);
  for (const View& view : views)
    bytes += view.features.capacity() * sizeof(ViewFeature);
  return bytes;
}

int turnsOf(const View& view, const ViewParams& params)
{
  return std::max(1, cvRound(params.turns * view.spin / kFullTurn));
}

void validate(const ViewModel& model)
{
  checkFields(model.params);
  const SymmetryGroup symmetries(model.symmetries);
  checkExtent(model.extent);
  require(model.levels.size() == static_cast<std::size_t>(model.params.subdivisions) + 1, "the number of levels",
          static_cast<double>(model.levels.size()), "one more than the subdivisions");
  require(model.levels.front() > 0 && std::is_sorted(model.levels.begin(), model.levels.end()) &&
              model.levels.back() <= kMaxViews,
          "the number of views of a model", model.levels.back(),
          "from 1 to " + std::to_string(kMaxViews) + ", and more in each level");
  require(model.views.size() <= static_cast<std::size_t>(model.levels.back()), "the number of views",
          static_cast<double>(model.views.size()), "at most " + std::to_string(model.levels.back()));
  for (std::size_t i = 0; i < model.views.size(); ++i)
  {
    const std::string fault = faultOf(model.views[i], static_cast<int>(i), model);
    require(fault.empty(), "view " + std::to_string(i) + " of a model", "damaged", fault);
  }
}

}  // namespace robot_vision
