// What ROS adds to the kernels inside a nodelet manager: bench_in_process IMAGE WIDTH HEIGHT FRAMES THREADS
//
// The same frames, in turns: the bare OpenCV chain, the core's EdgeDetector, and the edge_detector nodelet of a manager
// in this process, from publish() to the callback of a subscriber of its result. THREADS is OpenCV's for all three,
// 0: as many as it likes. Prints JSON: medians over the frames of the process' CPU time and the wall time in ms.

#include <nodelet/loader.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <algorithm>
#include <array>
#include <boost/function.hpp>
#include <cstdlib>
#include <functional>

#include "moving_messages.hpp"
#include "nodelets/factories.hpp"
#include "robot_vision/edges/edges.hpp"

namespace
{

constexpr int kNotCounted = 4;
constexpr int kCounted = 12;

using Message = sensor_msgs::ImagePtr;
using Work = std::function<void(const Message& frame)>;

/// The nodelet in its manager, with somebody before and after it.
class Manager
{
public:
  Manager() : loader_(Factory([](const std::string&) { return robot_vision::makeEdgeDetector(); }))
  {
    ros::NodeHandle nh;
    publisher_ = nh.advertise<sensor_msgs::Image>("image", 1);
    subscriber_ = nh.subscribe("edge_detector/processed_image", 1, &Manager::onResult, this);
    if (!loader_.load("/edge_detector", "edge_detector", {}, {})) throw std::runtime_error("the nodelet does not load");
    for (int i = 0; publisher_.getNumSubscribers() == 0; ++i)
    {
      if (i == 1000) throw std::runtime_error("the nodelet does not subscribe");
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
    }
  }

  void process(const Message& frame)
  {
    result_.reset();
    frame->header.stamp = ros::Time::now();
    publisher_.publish(frame);
    for (int i = 0; !result_ && i < 100; ++i)
      ros::getGlobalCallbackQueue()->callOne(ros::WallDuration(0.1));
    if (!result_) throw std::runtime_error("the nodelet does not answer");
  }

private:
  using Factory = boost::function<boost::shared_ptr<nodelet::Nodelet>(const std::string& type)>;

  void onResult(const sensor_msgs::ImageConstPtr& result) { result_ = result; }

  nodelet::Loader loader_;
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
  sensor_msgs::ImageConstPtr result_;
};

struct Times
{
  std::vector<double> cpu_ms;
  std::vector<double> wall_ms;

  void measure(const Work& work, const Message& frame)
  {
    const double wall = bench::seconds(CLOCK_MONOTONIC);
    const double cpu = bench::seconds(CLOCK_PROCESS_CPUTIME_ID);
    work(frame);
    cpu_ms.push_back((bench::seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu) * 1e3);
    wall_ms.push_back((bench::seconds(CLOCK_MONOTONIC) - wall) * 1e3);
  }
};

/// Turns are short, so that the noise of the machine meets all alike. The first frames of each are not counted: the
/// work moves to another thread, and with it to other caches.
void takeTurn(const Work& work, const std::vector<Message>& messages, Times& times)
{
  Times not_counted;
  for (int i = 0; i < kNotCounted + kCounted; ++i)
    (i < kNotCounted ? not_counted : times).measure(work, messages[static_cast<std::size_t>(i) % messages.size()]);
}

void run(const std::vector<Message>& messages, int frames)
{
  bench::EdgeChain chain;
  robot_vision::EdgeDetector detector;
  Manager manager;
  cv::Mat edges[2];
  const std::array<Work, 3> works = {
      [&](const Message& frame) { chain.apply(bench::view(*frame, CV_8UC3), edges[0]); },
      [&](const Message& frame) { detector.apply(bench::view(*frame, CV_8UC3), "bgr8", edges[1]); },
      [&](const Message& frame) { manager.process(frame); },
  };
  std::array<Times, works.size()> times;
  for (int begin = 0; begin < frames; begin += kCounted)
    for (std::size_t which = 0; which < works.size(); ++which)
      takeTurn(works[which], messages, times[which]);
  const std::array<const char*, works.size()> names = {"opencv", "core", "nodelet"};
  std::printf("{\"threads\": %d", cv::getNumThreads());
  for (std::size_t which = 0; which < works.size(); ++which)
    std::printf(", \"%s\": {\"cpu_ms\": %.4f, \"wall_ms\": %.4f}", names[which], bench::median(times[which].cpu_ms),
                bench::median(times[which].wall_ms));
  std::printf("}\n");
}

}  // namespace

int main(int argc, char** argv)
try
{
  ros::init(argc, argv, "bench_in_process");
  if (argc != 6) throw std::invalid_argument("bench_in_process IMAGE WIDTH HEIGHT FRAMES THREADS");
  const int threads = std::atoi(argv[5]);
  if (threads > 0) cv::setNumThreads(threads);
  ros::NodeHandle nh;
  run(bench::movingMessages(argv[1], {std::atoi(argv[2]), std::atoi(argv[3])}, false), std::max(std::atoi(argv[4]), 1));
  return 0;
}
catch (const std::exception& e)
{
  std::fprintf(stderr, "bench_in_process: %s\n", e.what());
  return 1;
}
