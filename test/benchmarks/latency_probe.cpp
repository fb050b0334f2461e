// Both ends of a measurement: publishes a moving photograph on `image`, and a camera_info beside it, and waits for what
// others make of it on `result`, which keeps the stamp. Prints JSON: latencies from stamp to arrival, CPU time of the
// processes ~pids.
//
// ~image (empty: the stamps are another's, e.g. a camera's; only listen), ~width, ~height, ~rate (Hz), ~seconds,
// ~warm_up (s, not counted), ~pids ("12 34"), ~expect: what one result is compared with: "", opencv, opencv_apps,
// ~results (false: the processes note themselves when images arrive), ~still (a box moves instead of the image),
// ~depth (the topic of a depth camera's images that are published, too; empty: none), ~cloud (the result is one)

#include <image_transport/camera_common.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>

#include <map>
#include <mutex>
#include <optional>
#include <sstream>

#include "depth_source.hpp"
#include "moving_messages.hpp"
#include "ros/camera/scene_messages.hpp"

namespace
{

constexpr double kDeadline = 20.0;  // s, for the others to connect
constexpr double kLastWait = 0.5;   // s, for the results still under way at the end

struct Settings
{
  std::string image;
  int width = 640;
  int height = 480;
  double rate = 30.0;
  double seconds = 4.0;
  double warm_up = 1.0;
  std::string expect;
  bool results = true;
  bool still = false;
  std::string depth;
  bool cloud = false;
  std::vector<clockid_t> clocks;
};

Settings readSettings()
{
  const ros::NodeHandle pnh("~");
  Settings settings;
  std::string pids;
  pnh.getParam("image", settings.image);
  pnh.getParam("width", settings.width);
  pnh.getParam("height", settings.height);
  pnh.getParam("rate", settings.rate);
  pnh.getParam("seconds", settings.seconds);
  pnh.getParam("warm_up", settings.warm_up);
  pnh.getParam("expect", settings.expect);
  pnh.getParam("results", settings.results);
  pnh.getParam("still", settings.still);
  pnh.getParam("depth", settings.depth);
  pnh.getParam("cloud", settings.cloud);
  pnh.getParam("pids", pids);
  std::istringstream stream(pids);
  for (pid_t pid = 0; stream >> pid;)
    settings.clocks.push_back(bench::clockOf(pid));
  return settings;
}

double cpuSeconds(const std::vector<clockid_t>& clocks)
{
  double sum = 0.0;
  for (const clockid_t clock : clocks)
    sum += bench::seconds(clock);
  return sum;
}

/// What opencv_apps' edge_detection does to a BGR image, which it takes for RGB.
cv::Mat opencvAppsEdges(const cv::Mat& bgr)
{
  cv::Mat smooth;
  cv::Mat gray;
  cv::Mat edges;
  cv::GaussianBlur(bgr, smooth, {3, 3}, 0);
  cv::cvtColor(smooth, gray, cv::COLOR_RGB2GRAY);
  cv::blur(gray, gray, {7, 7});
  cv::Canny(gray, edges, 15.0, 30.0);
  return edges;
}

cv::Mat opencvEdges(const cv::Mat& bgr)
{
  cv::Mat edges;
  bench::EdgeChain().apply(bgr, edges);
  return edges;
}

double samePixels(const sensor_msgs::Image& message, const cv::Mat& expected)
{
  if (message.data.size() != expected.total() || message.step != expected.step) return 0.0;
  return 1.0 - cv::countNonZero(bench::view(message, CV_8UC1) != expected) / static_cast<double>(expected.total());
}

/// Notes when results arrive, in a thread of its own.
class Results
{
public:
  explicit Results(bool cloud) : spinner_(1)
  {
    ros::NodeHandle nh;
    const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
    subscriber_ = cloud ? nh.subscribe("result", 10, &Results::onCloud, this, hints)
                        : nh.subscribe("result", 10, &Results::onImage, this, hints);
    spinner_.start();
  }

  bool connected() const { return subscriber_.getNumPublishers() > 0; }

  /// The latencies in ms of the results with a stamp from `begin` to `end`.
  std::vector<double> latencies(const ros::Time& begin, const ros::Time& end)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::vector<double> ms;
    for (const auto& [stamp, arrival] : arrivals_)
      if (stamp >= begin && stamp <= end) ms.push_back((arrival - stamp).toSec() * 1e3);
    return ms;
  }

  sensor_msgs::ImageConstPtr last()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    return last_;
  }

private:
  void onImage(const sensor_msgs::ImageConstPtr& message)
  {
    note(message->header.stamp);
    const std::lock_guard<std::mutex> lock(mutex_);
    last_ = message;
  }

  void onCloud(const sensor_msgs::PointCloud2ConstPtr& message) { note(message->header.stamp); }

  void note(const ros::Time& stamp)
  {
    const ros::Time now = ros::Time::now();
    const std::lock_guard<std::mutex> lock(mutex_);
    arrivals_[stamp] = now;
  }

  std::mutex mutex_;  // guards arrivals_ and last_
  std::map<ros::Time, ros::Time> arrivals_;
  sensor_msgs::ImageConstPtr last_;
  ros::Subscriber subscriber_;
  ros::AsyncSpinner spinner_;
};

/// Of a camera without distortion whose image is as wide as 1.2 focal lengths.
sensor_msgs::CameraInfo cameraInfo(cv::Size size)
{
  const double f = size.width / 1.2, x = size.width / 2.0, y = size.height / 2.0;
  const cv::Matx33d matrix(f, 0.0, x, 0.0, f, y, 0.0, 0.0, 1.0);
  return robot_vision::toCameraInfo({size.width, size.height, matrix, std::vector<double>(5)});
}

template <class Condition>
void waitFor(const std::string& what, const Condition& condition)
{
  const double deadline = bench::seconds(CLOCK_MONOTONIC) + kDeadline;
  while (!condition())
  {
    if (!ros::ok() || bench::seconds(CLOCK_MONOTONIC) > deadline) throw std::runtime_error("waited in vain: " + what);
    ros::WallDuration(0.01).sleep();
  }
}

class Measurement
{
public:
  explicit Measurement(Settings settings) : settings_(std::move(settings)), results_(settings_.cloud) {}

  bench::Result run()
  {
    if (settings_.results) waitFor("for somebody who publishes the result", [this] { return results_.connected(); });
    if (settings_.image.empty())
      listen();
    else
      publish();
    result_.seconds = bench::seconds(CLOCK_MONOTONIC) - wall_begin_;
    result_.cpu_seconds = cpuSeconds(settings_.clocks) - cpu_begin_;
    result_.begin = begin_.toSec();
    result_.end = end_.toSec();
    result_.latencies_ms = results_.latencies(begin_, end_);
    return result_;
  }

private:
  void begin(const ros::Time& stamp)
  {
    begin_ = stamp;
    wall_begin_ = bench::seconds(CLOCK_MONOTONIC);
    cpu_begin_ = cpuSeconds(settings_.clocks);
  }

  void listen()
  {
    if (settings_.results) waitFor("for a result", [this] { return results_.last() != nullptr; });
    ros::WallDuration(settings_.warm_up).sleep();
    begin(ros::Time::now());
    ros::WallDuration(settings_.seconds).sleep();
    end_ = ros::Time::now();
    result_.sent = static_cast<int>(settings_.seconds * settings_.rate + 0.5);
  }

  void publish()
  {
    const cv::Size size(settings_.width, settings_.height);
    const auto messages = bench::movingMessages(settings_.image, size, settings_.still);
    ros::NodeHandle nh;
    ros::Publisher publisher = nh.advertise<sensor_msgs::Image>("image", 1);
    const std::string beside = image_transport::getCameraInfoTopic(nh.resolveName("image"));
    ros::Publisher info_publisher = nh.advertise<sensor_msgs::CameraInfo>(beside, 1);
    sensor_msgs::CameraInfo info = cameraInfo(size);
    std::optional<bench::DepthSource> depth;
    if (!settings_.depth.empty()) depth.emplace(nh, settings_.depth, messages.front()->header.frame_id);
    waitFor("for somebody who takes the image",
            [&] { return depth ? depth->connected() : publisher.getNumSubscribers() > 0; });
    const int warm_up = static_cast<int>(settings_.warm_up * settings_.rate);
    result_.sent = static_cast<int>(settings_.seconds * settings_.rate);
    ros::WallRate rate(settings_.rate);
    for (int i = 0; i < warm_up + result_.sent && ros::ok(); ++i)
    {
      rate.sleep();
      const sensor_msgs::ImagePtr& message = messages[static_cast<std::size_t>(i) % messages.size()];
      message->header.stamp = ros::Time::now();
      if (i == warm_up) begin(message->header.stamp);
      end_ = message->header.stamp;
      publisher.publish(message);
      info.header = message->header;
      info_publisher.publish(info);
      if (depth) depth->publish(i, message->header.stamp);
    }
    if (!settings_.results) return;
    awaitLast();
    compare(*messages[static_cast<std::size_t>(warm_up + result_.sent - 1) % messages.size()]);
  }

  void awaitLast()
  {
    const double deadline = bench::seconds(CLOCK_MONOTONIC) + kLastWait;
    while (results_.latencies(end_, end_).empty() && bench::seconds(CLOCK_MONOTONIC) < deadline)
      ros::WallDuration(0.001).sleep();
  }

  void compare(const sensor_msgs::Image& sent)
  {
    const sensor_msgs::ImageConstPtr last = results_.last();
    if (settings_.expect.empty() || !last || last->header.stamp != end_) return;
    const cv::Mat image = bench::view(sent, CV_8UC3);
    const cv::Mat expected = settings_.expect == "opencv" ? opencvEdges(image) : opencvAppsEdges(image);
    result_.same_pixels = samePixels(*last, expected);
  }

  Settings settings_;
  Results results_;
  bench::Result result_;
  ros::Time begin_;  // stamps of the first and the last frame counted
  ros::Time end_;
  double wall_begin_ = 0.0;
  double cpu_begin_ = 0.0;
};

}  // namespace

int main(int argc, char** argv)
try
{
  ros::init(argc, argv, "latency_probe");
  ros::NodeHandle nh;
  bench::print(Measurement(readSettings()).run());
  return 0;
}
catch (const std::exception& e)
{
  std::fprintf(stderr, "latency_probe: %s\n", e.what());
  return 1;
}
