#include "stereo_pairs.hpp"

#include "robot_vision/common/range.hpp"
#include "ros/images/stamps.hpp"
#include "ros/images/waiting_images.hpp"

namespace robot_vision
{
namespace
{

/// The index of the newest message of a stamp.
template <class Messages>
std::optional<std::size_t> indexOf(const Messages& messages, const ros::Time& stamp)
{
  for (std::size_t i = messages.size(); i-- > 0;)
    if (messages[i]->header.stamp == stamp) return i;
  return std::nullopt;
}

/// Takes a message out, and drops the older ones.
template <class Messages>
typename Messages::value_type takeOut(Messages& messages, std::size_t index)
{
  const typename Messages::value_type taken = messages[index];
  messages.erase(messages.begin(), messages.begin() + static_cast<std::ptrdiff_t>(index) + 1);
  return taken;
}

/// That the stamps of two topics do not meet.
std::string apart(const std::string& a, const ros::Time& of_a, const std::string& b, const ros::Time& of_b,
                  const std::string& expected)
{
  return "the stamps on " + a + " and " + b + " do not meet: the newest are " + timeText(of_a) + " s and " +
         timeText(of_b) + " s, must be " + expected;
}

}  // namespace

std::optional<StereoPair> StereoPairs::add(std::size_t side, const sensor_msgs::ImageConstPtr& image)
{
  auto& images = cameras_[side].images;
  images.push_back(image);
  dropOldest(
      images, kMaxImages, [](const auto& one) -> const auto& { return *one; });
  ++unpaired_;
  rights_alone_ = side == kRight ? rights_alone_ + 1 : 0;
  return take();
}

std::optional<StereoPair> StereoPairs::add(std::size_t side, const sensor_msgs::CameraInfoConstPtr& info)
{
  auto& infos = cameras_[side].infos;
  infos.push_back(info);
  if (infos.size() > kMaxInfos) infos.pop_front();
  return take();
}

std::optional<StereoPair> StereoPairs::take()
{
  Camera &left = cameras_[kLeft], &right = cameras_[kRight];
  for (std::size_t i = left.images.size(); i-- > 0;)
  {
    const ros::Time stamp = left.images[i]->header.stamp;
    const auto left_info = indexOf(left.infos, stamp);
    const auto partner = nearestRight(stamp);
    if (!left_info || !partner) continue;
    StereoPair pair;
    pair.images = {takeOut(left.images, i), takeOut(right.images, *partner)};
    const auto right_info = indexOf(right.infos, pair.images[kRight]->header.stamp);
    pair.infos = {takeOut(left.infos, *left_info), takeOut(right.infos, *right_info)};
    unpaired_ = rights_alone_ = 0;
    return pair;
  }
  return std::nullopt;
}

/// The index of the right image nearest in time to a left one, among those that are near enough and have camera_info.
std::optional<std::size_t> StereoPairs::nearestRight(const ros::Time& left) const
{
  const Camera& right = cameras_[kRight];
  std::optional<std::size_t> nearest;
  double least = slop_;
  for (std::size_t i = 0; i < right.images.size(); ++i)
  {
    const ros::Time stamp = right.images[i]->header.stamp;
    const double difference = secondsBetween(stamp, left);
    if (difference > least || !indexOf(right.infos, stamp)) continue;
    nearest = i;
    least = difference;
  }
  return nearest;
}

std::string StereoPairs::problem(std::size_t side, const StereoTopics& topics) const
{
  if (unpaired_ < kMaxUnpaired || (side == kRight && rights_alone_ % kMaxUnpaired != 0)) return "";
  return "no pairs for " + std::to_string(unpaired_) + " images: " + reason(topics);
}

std::string StereoPairs::reason(const StereoTopics& topics) const
{
  for (const std::size_t of : {kLeft, kRight})
  {
    if (cameras_[of].images.empty()) return "nothing has come on " + topics.images[of];
    if (cameras_[of].infos.empty()) return "nothing has come on " + topics.infos[of];
  }
  for (const std::size_t of : {kLeft, kRight})
  {
    const Camera& camera = cameras_[of];
    bool meet = false;
    for (const auto& image : camera.images)
      meet = meet || indexOf(camera.infos, image->header.stamp);
    if (!meet)
      return apart(topics.images[of], camera.images.back()->header.stamp, topics.infos[of],
                   camera.infos.back()->header.stamp, "equal");
  }
  const std::string expected =
      slop_ > 0.0 ? "at most slop, " + toText(slop_) + " s, apart" : "equal; slop allows cameras that are not in step";
  return apart(topics.images[kLeft], cameras_[kLeft].images.back()->header.stamp, topics.images[kRight],
               cameras_[kRight].images.back()->header.stamp, expected);
}

void StereoPairs::clear()
{
  cameras_ = {};
  unpaired_ = rights_alone_ = 0;
}

}  // namespace robot_vision
