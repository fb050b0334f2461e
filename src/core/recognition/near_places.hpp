#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <unordered_map>
#include <utility>
#include <vector>

namespace robot_vision
{

/// Indices of places, by cubes with sides as long as the distance within which two are near: few of many are compared
/// with each other.
class NearPlaces
{
public:
  /// `distance` is above 0, in m.
  explicit NearPlaces(double distance) : distance_(distance) {}

  /// Forgets all, and has another distance.
  void begin(double distance)
  {
    distance_ = distance;
    cubes_.clear();
  }

  void add(const cv::Vec3d& place, std::size_t index) { cubes_[keyOf(cubeAt(place))].push_back(index); }

  /// Calls test(index) for all within the distance, and for some that are farther away, until it returns true for one.
  template <class Test>
  bool anyNear(const cv::Vec3d& place, const Test& test) const
  {
    const cv::Vec3i cube = cubeAt(place);
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z)
        {
          const auto found = cubes_.find(keyOf(cube + cv::Vec3i(x, y, z)));
          if (found != cubes_.end() && std::any_of(found->second.begin(), found->second.end(), test)) return true;
        }
    return false;
  }

private:
  static constexpr int kBits = 21;                             // of a cube's number along each axis
  static constexpr double kFarthest = (1 << (kBits - 1)) - 2;  // cubes

  cv::Vec3i cubeAt(const cv::Vec3d& place) const
  {
    cv::Vec3i cube;
    for (int i = 0; i < 3; ++i)  // also of what is too far away for an integer
      cube[i] = cvFloor(std::clamp(place[i] / distance_, -kFarthest, kFarthest));
    return cube;
  }

  static std::uint64_t keyOf(const cv::Vec3i& cube)
  {
    const auto part = [](int number) { return static_cast<std::uint64_t>(number) & ((std::uint64_t{1} << kBits) - 1); };
    return part(cube[0]) << 2 * kBits | part(cube[1]) << kBits | part(cube[2]);
  }

  double distance_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cubes_;
};

/// How many places there are at each spot, which is what is within a distance of the first place there.
class SpotCounts
{
public:
  /// `distance` is above 0, in m.
  explicit SpotCounts(double distance) : distance_(distance), near_(distance) {}

  /// Adds a place, and returns how many there are at its spot now.
  std::size_t add(const cv::Vec3d& place)
  {
    std::size_t spot = spots_.size();
    near_.anyNear(place,
                  [&](std::size_t i)
                  {
                    const cv::Vec3d gap = spots_[i].first - place;
                    if (gap.dot(gap) < distance_ * distance_) spot = i;
                    return spot == i;
                  });
    if (spot == spots_.size())
    {
      near_.add(place, spot);
      spots_.emplace_back(place, 0);
    }
    return ++spots_[spot].second;
  }

private:
  double distance_;
  NearPlaces near_;
  std::vector<std::pair<cv::Vec3d, std::size_t>> spots_;  // the first place, and how many there are
};

}  // namespace robot_vision
