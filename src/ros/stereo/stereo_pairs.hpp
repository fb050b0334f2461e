#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <string>

namespace robot_vision
{

// The two cameras of a pair, as indices.
constexpr std::size_t kLeft = 0, kRight = 1;

/// Images of both cameras that belong together, each with its calibration.
struct StereoPair
{
  std::array<sensor_msgs::ImageConstPtr, 2> images;
  std::array<sensor_msgs::CameraInfoConstPtr, 2> infos;
};

/// The topics of both cameras.
struct StereoTopics
{
  std::array<std::string, 2> images;
  std::array<std::string, 2> infos;
};

/// Finds images of two cameras that belong together by their stamps, in whichever order they come. An image and its
/// camera_info have the same stamp; both images have the same, or differ by `slop` (s) at most. Of several that fit the
/// newest left image is taken, and the right one nearest to it; what is older is dropped. Keeps few messages: the
/// oldest ones go. Not thread-safe.
class StereoPairs
{
public:
  static constexpr std::size_t kMaxImages = 8;     // that wait, of each camera
  static constexpr std::size_t kMaxInfos = 32;     // likewise
  static constexpr std::size_t kMaxUnpaired = 20;  // images in a row without a pair, until that is told

  explicit StereoPairs(double slop = 0.0) : slop_(slop) {}

  /// Adds a message of the camera `side`. Returns the pair that it makes complete.
  std::optional<StereoPair> add(std::size_t side, const sensor_msgs::ImageConstPtr& image);
  std::optional<StereoPair> add(std::size_t side, const sensor_msgs::CameraInfoConstPtr& info);

  /// Since how many images there are no pairs, and why, in one line that names topics; empty until so many in a row
  /// have none. To be asked once an image of the camera `side` was added. Of right images it is empty but each time
  /// that so many have come without a left one, because left ones are what is counted.
  std::string problem(std::size_t side, const StereoTopics& topics) const;

  /// Forgets all messages.
  void clear();

private:
  struct Camera
  {
    std::deque<sensor_msgs::ImageConstPtr> images;
    std::deque<sensor_msgs::CameraInfoConstPtr> infos;
  };

  std::optional<StereoPair> take();
  std::string reason(const StereoTopics& topics) const;
  std::optional<std::size_t> nearestRight(const ros::Time& left) const;

  double slop_;
  std::array<Camera, 2> cameras_;
  std::size_t unpaired_ = 0;      // images since the last pair
  std::size_t rights_alone_ = 0;  // right images since the last pair or left image
};

}  // namespace robot_vision
