#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <unordered_map>
#include <vector>

namespace robot_vision
{

/// Indices by places, in cubes with sides as long as the distance within which they are near, so that few of many are
/// compared with each other.
class NearPoses
{
public:
  /// `distance` is above 0, in m.
  explicit NearPoses(double distance) : distance_(distance) {}

  void add(const cv::Vec3d& place, std::size_t index) { cubes_[keyOf(cubeAt(place))].push_back(index); }

  /// Whether test(index) is true for one of those whose places are within the distance, and perhaps for others.
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
  cv::Vec3i cubeAt(const cv::Vec3d& place) const
  {
    return {cvFloor(place[0] / distance_), cvFloor(place[1] / distance_), cvFloor(place[2] / distance_)};
  }

  static std::uint64_t keyOf(const cv::Vec3i& cube)
  {
    constexpr int kBits = 21;
    const auto part = [](int number) { return static_cast<std::uint64_t>(number) & ((std::uint64_t{1} << kBits) - 1); };
    return part(cube[0]) << 2 * kBits | part(cube[1]) << kBits | part(cube[2]);
  }

  double distance_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cubes_;
};

}  // namespace robot_vision
