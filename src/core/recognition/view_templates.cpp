#include "view_templates.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core/affine.hpp>

#include "feature_bins.hpp"

namespace robot_vision
{
namespace
{

constexpr double kFullTurn = 2.0 * CV_PI;

cv::Matx33d rotationOf(const View& view)
{
  return cv::Affine3d(view.rotation, cv::Vec3d()).rotation();
}

/// A feature of the code: the plane that it is seen in when the view is turned.
std::uint16_t planeOf(const ViewFeature& feature, double step, double turn, double half_width)
{
  const double c = std::cos(turn), s = std::sin(turn);
  const auto cell = [&](double position)
  { return std::clamp(static_cast<int>(std::floor((position / half_width + 1.0) * 0.5 * kCells)), 0, kCells - 1); };
  const double x = feature.x * step, y = feature.y * step;
  const int at = cell(s * x + c * y) * kCells + cell(c * x - s * y);
  int bin = 0;
  if (feature.kind == FeatureKind::kSurface)
    bin = kBins + surfaceBin((c * feature.a - s * feature.b) / 127.0, (s * feature.a + c * feature.b) / 127.0);
  else
    bin = edgeBin((feature.a + 0.5) * CV_PI / 128.0 + turn);
  return static_cast<std::uint16_t>(at * kCellBins + bin);
}

/// Indices of the features that a code is made of, each half of it of half of the contours and half of the surfaces. If
/// there are too few, they are in it more than once; if there is none of a kind, others take their place.
std::vector<std::size_t> codeFeatures(const View& view, bool with_depth)
{
  std::vector<std::size_t> kinds[3];
  for (std::size_t i = 0; i < view.features.size(); ++i)
    kinds[static_cast<int>(view.features[i].kind)].push_back(i);
  std::vector<std::size_t>&contours = kinds[static_cast<int>(FeatureKind::kContour)],
  &inner = kinds[static_cast<int>(FeatureKind::kInner)], &surfaces = kinds[static_cast<int>(FeatureKind::kSurface)];
  if (contours.empty()) contours = inner;
  if (!with_depth) surfaces = inner;
  if (surfaces.empty()) surfaces = contours;
  if (contours.empty()) contours = surfaces;
  std::vector<std::size_t> chosen;
  if (contours.empty()) return chosen;
  const auto take = [&](const std::vector<std::size_t>& from, int begin, int end)
  {
    for (int i = begin; i < end; ++i)
      chosen.push_back(from[static_cast<std::size_t>(i) % from.size()]);
  };
  for (int half = 0; half < 2; ++half)
  {
    take(contours, half * kCodeContours / 2, (half + 1) * kCodeContours / 2);
    take(surfaces, half * kCodeSurfaces / 2, (half + 1) * kCodeSurfaces / 2);
  }
  return chosen;
}

class CodeMaker
{
public:
  CodeMaker(const ViewModel& model, double half_width, bool with_depth) : model_(model), half_width_(half_width)
  {
    for (const View& view : model.views)
      chosen_.push_back(codeFeatures(view, with_depth));
  }

  bool hasCode(int view) const { return !chosen_[static_cast<std::size_t>(view)].empty(); }

  void add(int view, double turn, TemplateCodes& to) const
  {
    to.templates.push_back({view, turn});
    for (const std::size_t i : chosen_[static_cast<std::size_t>(view)])
      to.features.push_back(
          planeOf(model_.views[static_cast<std::size_t>(view)].features[i], model_.step(), turn, half_width_));
  }

  void addPoints(std::vector<float>& to) const
  {
    const auto step = static_cast<float>(model_.step());
    for (std::size_t i = 0; i < chosen_.size(); ++i)
    {
      const std::vector<ViewFeature>& features = model_.views[i].features;
      std::vector<float> points(3 * static_cast<std::size_t>(kCodeFeatures));
      for (std::size_t k = 0; k < chosen_[i].size(); ++k)
      {
        points[k] = step * features[chosen_[i][k]].x;
        points[kCodeFeatures + k] = step * features[chosen_[i][k]].y;
        points[2 * kCodeFeatures + k] = step * features[chosen_[i][k]].z;
      }
      to.insert(to.end(), points.begin(), points.end());
    }
  }

private:
  const ViewModel& model_;
  double half_width_;
  std::vector<std::vector<std::size_t>> chosen_;
};

/// How much a view is turned about the line of sight against another one that is as near to it as any turn makes it.
double turnBetween(const cv::Matx33d& view, const cv::Matx33d& other, const SymmetryGroup& symmetries)
{
  constexpr int kTries = 16;
  double best_angle = kFullTurn;
  cv::Matx33d best;
  for (int i = 0; i < kTries; ++i)
  {
    const cv::Matx33d turned = turnInImage(kFullTurn * i / kTries) * other;
    const cv::Matx33d alike = symmetries.nearest(view, turned);
    const double angle = rotationAngle(turned.t() * alike);
    if (angle < best_angle) best = alike;
    best_angle = std::min(best_angle, angle);
  }
  const cv::Matx33d difference = best * other.t();
  return std::atan2(difference(1, 0) - difference(0, 1), difference(0, 0) + difference(1, 1));
}

/// The coarse view that a view belongs to.
int coarseView(const ViewModel& model, int view, int coarse_views)
{
  while (view >= coarse_views)
    view = model.views[static_cast<std::size_t>(view)].parent;
  return view;
}

}  // namespace

cv::Matx33d turnInImage(double angle)
{
  const double c = std::cos(angle), s = std::sin(angle);
  return {c, -s, 0, s, c, 0, 0, 0, 1};
}

double ViewTemplates::reachOf(const ViewModel& model)
{
  double reach = 0.0;
  for (const View& view : model.views)
    for (const ViewFeature& feature : view.features)
      reach = std::max(reach, std::hypot(feature.x * model.step(), feature.y * model.step()));
  return reach;
}

ViewTemplates::ViewTemplates(const ViewModel& model, double half_width, bool with_depth)
{
  const SymmetryGroup symmetries(model.symmetries);
  const CodeMaker maker(model, half_width, with_depth);
  maker.addPoints(points_);
  const int all = static_cast<int>(model.views.size());
  const int coarse_views = model.levels.size() < 2 ? all : std::min(all, model.levels[model.levels.size() - 2]);
  std::vector<std::size_t> first(static_cast<std::size_t>(coarse_views) + 1);  // coarse template of each coarse view
  std::vector<std::vector<Template>> members;
  for (int i = 0; i < coarse_views; ++i)
  {
    const View& view = model.views[static_cast<std::size_t>(i)];
    const int turns = maker.hasCode(i) ? (turnsOf(view, model.params) + 1) / 2 : 0;
    for (int k = 0; k < turns; ++k)
      maker.add(i, view.spin * k / turns, coarse_);
    first[static_cast<std::size_t>(i) + 1] = coarse_.templates.size();
  }
  members.resize(coarse_.templates.size());
  for (int i = 0; i < all; ++i)
  {
    const View& view = model.views[static_cast<std::size_t>(i)];
    const auto parent = static_cast<std::size_t>(coarseView(model, i, coarse_views));
    const auto parent_turns = static_cast<int>(first[parent + 1] - first[parent]);
    if (!maker.hasCode(i) || parent_turns == 0) continue;
    const double offset = turnBetween(rotationOf(view), rotationOf(model.views[parent]), symmetries);
    const double parent_step = model.views[parent].spin / parent_turns;
    const int turns = turnsOf(view, model.params);
    for (int k = 0; k < turns; ++k)
    {
      const double turn = view.spin * k / turns;
      const int nearest = parent_step > 0.0 ? static_cast<int>(std::lround((turn + offset) / parent_step)) : 0;
      const int wrapped = (nearest % parent_turns + parent_turns) % parent_turns;
      members[first[parent] + static_cast<std::size_t>(wrapped)].push_back({i, turn});
    }
  }
  for (const std::vector<Template>& group : members)
  {
    children_.push_back(fine_.templates.size());
    for (const Template& member : group)
      maker.add(member.view, member.turn, fine_);
  }
  children_.push_back(fine_.templates.size());
}

std::size_t ViewTemplates::memory() const
{
  const auto of = [](const TemplateCodes& codes)
  { return codes.templates.capacity() * sizeof(Template) + codes.features.capacity() * sizeof(std::uint16_t); };
  return sizeof *this + of(coarse_) + of(fine_) + children_.capacity() * sizeof(std::size_t) +
         points_.capacity() * sizeof(float);
}

}  // namespace robot_vision
