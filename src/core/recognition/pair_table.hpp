#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "oriented_points.hpp"
#include "robot_vision/recognition/point_pairs.hpp"

namespace robot_vision
{

/// The frame of a point of a surface: its normal and two directions across it.
struct PointFrame
{
  PointFrame(const cv::Vec3f& place, const cv::Vec3f& normal);

  /// The angle of another point about the normal, in 65536ths of a turn.
  std::uint16_t angleOf(const cv::Vec3f& other) const;

  cv::Vec3f point;
  cv::Matx33f axes;  // rows: the normal, and two across it
};

/// What two points of a surface look like, as a number of a bin; and which bins there are.
class PairBins
{
public:
  static constexpr std::uint32_t kNone = 0xFFFFFFFF;

  explicit PairBins(const PointPairModel& model);

  std::uint32_t bins() const { return distances_ * angles_ * angles_ * angles_; }

  /// kNone if the points are one, or farther apart than any two of the object.
  std::uint32_t binOf(const cv::Vec3f& first, const cv::Vec3f& first_normal, const cv::Vec3f& second,
                      const cv::Vec3f& second_normal) const;

private:
  std::uint32_t angleBin(float cosine) const { return angle_bins_[static_cast<std::size_t>((cosine + 1.0F) * 511.5F)]; }

  float step_;     // m, of distances
  float largest_;  // m, squared
  std::uint32_t distances_, angles_;
  std::vector<std::uint32_t> angle_bins_;  // by the cosine
};

/// All pairs of the points of a model, by their bins.
class PairTable
{
public:
  explicit PairTable(const PointPairModel& model);

  struct Pair
  {
    std::uint16_t reference;  // index of the point
    std::uint16_t angle;      // of the other one about its normal, as PointFrame::angleOf()
  };

  const PairBins& bins() const { return bins_; }
  const Pair* begin(std::uint32_t bin) const { return pairs_.data() + starts_[bin]; }
  const Pair* end(std::uint32_t bin) const { return pairs_.data() + starts_[bin + 1]; }
  const std::vector<PointFrame>& frames() const { return frames_; }

private:
  PairBins bins_;
  std::vector<PointFrame> frames_;
  std::vector<std::uint32_t> starts_;  // of each bin
  std::vector<Pair> pairs_;
};

}  // namespace robot_vision
