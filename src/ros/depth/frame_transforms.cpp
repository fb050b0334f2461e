#include "frame_transforms.hpp"

#include <tf2/LinearMath/Matrix3x3.h>
#include <tf2/LinearMath/Quaternion.h>
#include <tf2/exceptions.h>

#include <cmath>

#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "ros/images/bounded_reading.hpp"
#include "ros/images/subscribing_lock.hpp"

namespace robot_vision
{
namespace
{

constexpr std::uint32_t kQueueSize = 100;
constexpr double kMaxAhead = 10.0;        // s, as long as tf2 keeps what was said
constexpr double kMaxLengthError = 0.01;  // of the square of a quaternion's length, tf2's own limit

std::string withoutSlash(const std::string& frame)
{
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

/// Why tf2 would leave a transform out, and log it each time that it comes; empty for one that it takes.
std::string flawOf(const geometry_msgs::TransformStamped& transform)
{
  const geometry_msgs::Vector3& t = transform.transform.translation;
  const geometry_msgs::Quaternion& q = transform.transform.rotation;
  for (const double value : {t.x, t.y, t.z, q.x, q.y, q.z, q.w})
    if (!std::isfinite(value)) return "has a number that is not finite";
  const double square = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  if (std::abs(square - 1.0) > kMaxLengthError)
    return "has a rotation of length " + toText(std::sqrt(square)) + ", must be 1";
  const std::string parent = withoutSlash(transform.header.frame_id), child = withoutSlash(transform.child_frame_id);
  if (parent.empty() || child.empty()) return "does not name both frames";
  return parent == child ? "has one frame for both" : "";
}

/// Whether a transform is of before the time went back: it can be on its way when the clock's message is here, and tf2
/// would leave out what is said from then on until the time is there again.
bool isOfTimeToCome(const geometry_msgs::TransformStamped& transform, const ros::Time& now)
{
  return ros::Time::isSimTime() && !now.isZero() && transform.header.stamp > now + ros::Duration(kMaxAhead);
}

cv::Affine3d toAffine(const geometry_msgs::Transform& transform)
{
  const geometry_msgs::Quaternion& q = transform.rotation;
  const tf2::Matrix3x3 r(tf2::Quaternion(q.x, q.y, q.z, q.w));
  const cv::Matx33d rotation(r[0][0], r[0][1], r[0][2], r[1][0], r[1][1], r[1][2], r[2][0], r[2][1], r[2][2]);
  return {rotation, {transform.translation.x, transform.translation.y, transform.translation.z}};
}

}  // namespace

void FrameTransforms::listen(bool listens)
{
  endSubscription(moving_);
  endSubscription(static_);
  buffer_.reset();  // tf2's clear() would keep the static transforms
  if (!listens) return;
  buffer_ = std::make_unique<tf2::BufferCore>();
  moving_ = subscribe("/tf", false);
  static_ = subscribe("/tf_static", true);
}

ros::Subscriber FrameTransforms::subscribe(const std::string& topic, bool is_static)
{
  const auto take = [this, topic, is_static](const tf2_msgs::TFMessageConstPtr& message)
  {
    lookAtClock();
    for (const geometry_msgs::TransformStamped& transform : message->transforms)
    {
      if (!is_static && isOfTimeToCome(transform, newest_)) continue;
      const std::string flaw = flawOf(transform);
      if (flaw.empty())
        buffer_->setTransform(transform, "tf", is_static);
      else if (throttle_.due())
        ROS_ERROR("%s: left out: the transform from '%s' to '%s' %s", topic.c_str(),
                  printable(transform.child_frame_id).c_str(), printable(transform.header.frame_id).c_str(),
                  flaw.c_str());
    }
  };
  ros::SubscribeOptions options = boundedOptions<tf2_msgs::TFMessage>(topic, kQueueSize, take);
  const SubscribingLock subscribing;
  return nh_.subscribe(options);
}

void FrameTransforms::lookAtClock()
{
  const ros::Time now = ros::Time::now();
  if (now < newest_) buffer_->clear();
  newest_ = now;
}

std::optional<cv::Affine3d> FrameTransforms::find(const std::string& to, const std::string& from) const
{
  if (to.empty() || from.empty()) return std::nullopt;  // tf2 would take two empty names for one frame
  if (withoutSlash(to) == withoutSlash(from)) return cv::Affine3d::Identity();
  if (!buffer_) return std::nullopt;
  try
  {
    return toAffine(buffer_->lookupTransform(withoutSlash(to), withoutSlash(from), ros::Time(0)).transform);
  }
  catch (const tf2::TransformException&)
  {
    return std::nullopt;
  }
}

}  // namespace robot_vision
