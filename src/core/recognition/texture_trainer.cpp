#include "robot_vision/recognition/texture_trainer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <vector>

#include "descriptor_index.hpp"
#include "robot_vision/common/range.hpp"
#include "texture_keypoints.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMergeRadius = 0.01;   // of the diameter: keypoints that are no farther apart are at one place
constexpr float kMaxSizeRatio = 1.5F;   // of keypoints that are one
constexpr double kMaxBits = 0.16;       // share of the bits that differ between two of them
constexpr double kMaxDistance = 180.0;  // of two descriptors of sift, whose norm is 512
constexpr double kOtherPlace = 0.05;    // of the diameter, between keypoints at different places
constexpr int kNeighbors = 8;           // that are looked at for one at another place that looks alike
constexpr double kExtentMargin = 1.1;   // times the radius, within which keypoints are the object's

using Cell = std::array<int, 3>;

struct CellHash
{
  std::size_t operator()(const Cell& cell) const
  {
    std::uint64_t hash = 0;
    for (const int number : cell)
      hash = hash * 0x9E3779B97F4A7C15U + static_cast<std::uint32_t>(number);
    return static_cast<std::size_t>(hash ^ hash >> 32U);
  }
};

/// How different two descriptors are; up to 1 they may be of the same place.
double difference(const cv::Mat& one, const cv::Mat& other)
{
  if (one.depth() == CV_32F) return cv::norm(one, other, cv::NORM_L2) / kMaxDistance;
  return cv::norm(one, other, cv::NORM_HAMMING) / (kMaxBits * 8.0 * one.cols);
}

/// Adds what another view has seen of a point.
void merge(const TexturePoint& seen, TexturePoint& point)
{
  const auto views = static_cast<float>(point.views);
  point.position = (point.position * views + seen.position) * (1.0F / (views + 1.0F));
  const cv::Vec3f sum = point.direction * views + seen.direction;
  if (cv::norm(sum) > 1e-3) point.direction = cv::normalize(sum);
  ++point.views;
}

}  // namespace

struct TextureTrainer::Impl
{
  explicit Impl(TextureModel learned) : model(std::move(learned)), radius(kMergeRadius * model.extent.diameter) {}

  void add(const TextureKeypoints& seen)
  {
    cells.clear();  // Points have moved since, and a training that goes on begins with where they are now.
    for (std::size_t i = 0; i < model.points.size(); ++i)
      cells[cellOf(model.points[i].position)].push_back(i);
    std::vector<bool> free(model.points.size(), true);
    for (std::size_t i = 0; i < seen.points.size(); ++i)
    {
      const TexturePoint& point = seen.points[i];
      if (cv::norm(cv::Vec3d(point.position) - model.extent.center) > kExtentMargin * model.extent.radius) continue;
      const cv::Mat descriptor = seen.descriptors.row(static_cast<int>(i));
      const std::size_t known = find(point, descriptor, free);
      if (known < free.size())
      {
        merge(point, model.points[known]);
        free[known] = false;
      }
      else
        append(point, descriptor);
    }
    ++model.views;
  }

  /// The most alike of the points of other views that are free; their number if there is none.
  std::size_t find(const TexturePoint& point, const cv::Mat& descriptor, const std::vector<bool>& free) const
  {
    std::size_t best = free.size();
    double least = 1.0;
    const Cell middle = cellOf(point.position);
    for (int i = 0; i < 27; ++i)
    {
      const auto there = cells.find({middle[0] + i / 9 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i % 3 - 1});
      if (there == cells.end()) continue;
      for (const std::size_t index : there->second)
      {
        if (!free[index] || !isSame(point, model.points[index])) continue;
        const double unlike = difference(descriptor, model.descriptors.row(static_cast<int>(index)));
        if (unlike > least || (best != free.size() && unlike == least)) continue;
        best = index;
        least = unlike;
      }
    }
    return best;
  }

  bool isSame(const TexturePoint& a, const TexturePoint& b) const
  {
    return cv::norm(a.position - b.position) <= radius && a.size <= kMaxSizeRatio * b.size &&
           b.size <= kMaxSizeRatio * a.size;
  }

  void append(const TexturePoint& point, const cv::Mat& descriptor)
  {
    require(model.points.size() < kMaxTexturePoints, "the number of keypoints of an object",
            static_cast<double>(model.points.size() + 1), "at most " + std::to_string(kMaxTexturePoints));
    model.points.push_back(point);
    model.descriptors.push_back(descriptor);
  }

  /// How many of some points look like no other place.
  std::size_t countUnique(const std::vector<std::size_t>& points) const
  {
    if (points.empty()) return 0;
    const TextureModel some = chosen(points);
    const std::vector<std::vector<cv::DMatch>> nearest =
        DescriptorIndex(some.descriptors).nearest(some.descriptors, kNeighbors);
    std::size_t count = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      const auto isElsewhere = [&](const cv::DMatch& match)
      {
        const auto other = static_cast<std::size_t>(match.trainIdx);
        const double apart = cv::norm(some.points[i].position - some.points[other].position);
        return apart > kOtherPlace * model.extent.diameter &&
               difference(some.descriptors.row(static_cast<int>(i)), some.descriptors.row(match.trainIdx)) <= 1.0;
      };
      if (std::none_of(nearest[i].begin(), nearest[i].end(), isElsewhere)) ++count;
    }
    return count;
  }

  TextureModel chosen(const std::vector<std::size_t>& points) const
  {
    TextureModel some{model.params, model.extent, model.views, {}, {}};
    for (const std::size_t i : points)
    {
      some.points.push_back(model.points[i]);
      some.descriptors.push_back(model.descriptors.row(static_cast<int>(i)));
    }
    return some;
  }

  Cell cellOf(const cv::Vec3f& position) const
  {
    return {cvFloor(position[0] / radius), cvFloor(position[1] / radius), cvFloor(position[2] / radius)};
  }

  TextureModel model;
  double radius;  // m, of what is one place
  std::unordered_map<Cell, std::vector<std::size_t>, CellHash> cells;
};

TextureTrainer::TextureTrainer(const TextureParams& params, const MeshExtent& extent)
{
  TextureModel empty;
  empty.params = params;
  empty.extent = extent;
  validate(empty);
  impl_ = std::make_unique<Impl>(empty);
}

TextureTrainer::TextureTrainer(const TextureModel& model)
{
  validate(model);
  TextureModel own = model;
  own.descriptors = model.descriptors.clone();
  impl_ = std::make_unique<Impl>(std::move(own));
}

TextureTrainer::~TextureTrainer() = default;
TextureTrainer::TextureTrainer(TextureTrainer&&) noexcept = default;
TextureTrainer& TextureTrainer::operator=(TextureTrainer&&) noexcept = default;

void TextureTrainer::add(const TextureView& view)
{
  impl_->add(textureKeypoints(view, impl_->model.params));
}

int TextureTrainer::views() const
{
  return impl_->model.views;
}

const TextureModel& TextureTrainer::state() const
{
  return impl_->model;
}

TextureModel TextureTrainer::model() const
{
  const TextureModel& all = impl_->model;
  std::vector<std::size_t> order(all.points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return all.points[a].views > all.points[b].views; });
  const auto end = std::find_if(order.begin(), order.end(),
                                [&](std::size_t i) { return all.points[i].views < all.params.min_views; });
  order.erase(end, order.end());
  const std::size_t unique = impl_->countUnique(order);
  require(
      unique >= kMinPoints, "the number of keypoints of the object that look like no other place of it",
      static_cast<double>(unique),
      "at least " + std::to_string(kMinPoints) + ": it has too little texture, and needs a method that knows shapes");
  order.resize(std::min(order.size(), static_cast<std::size_t>(all.params.max_points)));
  return impl_->chosen(order);
}

}  // namespace robot_vision
