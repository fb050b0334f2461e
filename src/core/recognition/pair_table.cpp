#include "pair_table.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision
{
namespace
{

constexpr std::uint32_t kMaxInBin = 400;  // pairs: what so many look like tells little, and costs most

/// Calls visit(reference, other, bin) for all pairs of different points.
template <class Visit>
void forPairs(const PointPairModel& model, const PairBins& bins, const Visit& visit)
{
  for (std::size_t i = 0; i < model.points.size(); ++i)
    for (std::size_t j = 0; j < model.points.size(); ++j)
    {
      if (i == j) continue;
      const std::uint32_t bin = bins.binOf(model.points[i], model.normals[i], model.points[j], model.normals[j]);
      if (bin != PairBins::kNone) visit(i, j, bin);
    }
}

}  // namespace

PointFrame::PointFrame(const cv::Vec3f& place, const cv::Vec3f& normal) : point(place)
{
  // Duff et al.: Building an Orthonormal Basis, Revisited, JCGT 2017.
  const float sign = std::copysign(1.0F, normal[2]), a = -1.0F / (sign + normal[2]), b = normal[0] * normal[1] * a;
  axes = {normal[0], normal[1],         normal[2], 1.0F + sign * normal[0] * normal[0] * a,
          sign * b,  -sign * normal[0], b,         sign + normal[1] * normal[1] * a,
          -normal[1]};
}

std::uint16_t PointFrame::angleOf(const cv::Vec3f& other) const
{
  const cv::Vec3f across = axes * (other - point);
  const auto turns = std::atan2(across[2], across[1]) * static_cast<float>(0.5 / CV_PI);
  return static_cast<std::uint16_t>(static_cast<std::int32_t>(std::floor(turns * 65536.0F)));
}

PairBins::PairBins(const PointPairModel& model)
  : step_(static_cast<float>(model.params.sampling * model.extent.diameter)),
    largest_(static_cast<float>(model.extent.diameter * model.extent.diameter)),
    distances_(static_cast<std::uint32_t>(std::floor(1.0 / model.params.sampling)) + 2),
    angles_(static_cast<std::uint32_t>(model.params.angle_steps / 2) + 1)
{
  const double step = 2.0 * CV_PI / model.params.angle_steps;
  for (int i = 0; i < 1024; ++i)
  {
    const double angle = std::acos(std::clamp(i / 511.5 - 1.0, -1.0, 1.0));
    angle_bins_.push_back(std::min(static_cast<std::uint32_t>(angle / step), angles_ - 1));
  }
}

std::uint32_t PairBins::binOf(const cv::Vec3f& first, const cv::Vec3f& first_normal, const cv::Vec3f& second,
                              const cv::Vec3f& second_normal) const
{
  const cv::Vec3f way = second - first;
  const float square = way.dot(way);
  if (!(square > 0.0F && square <= largest_)) return kNone;
  const float length = std::sqrt(square), inverse = 1.0F / length;
  const auto cosine = [](float value) { return std::clamp(value, -1.0F, 1.0F); };
  const std::uint32_t a = angleBin(cosine(first_normal.dot(way) * inverse));
  const std::uint32_t b = angleBin(cosine(second_normal.dot(way) * inverse));
  const std::uint32_t c = angleBin(cosine(first_normal.dot(second_normal)));
  const std::uint32_t distance = std::min(static_cast<std::uint32_t>(length / step_), distances_ - 1);
  return ((distance * angles_ + a) * angles_ + b) * angles_ + c;
}

PairTable::PairTable(const PointPairModel& model) : bins_(model), starts_(bins_.bins() + 1, 0)
{
  for (std::size_t i = 0; i < model.points.size(); ++i)
    frames_.emplace_back(model.points[i], model.normals[i]);
  std::vector<std::uint32_t> counts(bins_.bins(), 0);
  forPairs(model, bins_, [&](std::size_t, std::size_t, std::uint32_t bin) { ++counts[bin]; });
  for (std::size_t bin = 0; bin < counts.size(); ++bin)
    starts_[bin + 1] = starts_[bin] + std::min(counts[bin], kMaxInBin);
  pairs_.resize(starts_.back());
  std::vector<std::uint32_t> seen(counts.size(), 0);
  forPairs(model, bins_,
           [&](std::size_t i, std::size_t j, std::uint32_t bin)
           {
             // Of a full bin those are kept that are evenly among all of it.
             const std::uint64_t room = starts_[bin + 1] - starts_[bin], number = seen[bin]++;
             const std::uint64_t at = number * room / counts[bin];
             pairs_[starts_[bin] + at] = {static_cast<std::uint16_t>(i), frames_[i].angleOf(model.points[j])};
           });
}

}  // namespace robot_vision
