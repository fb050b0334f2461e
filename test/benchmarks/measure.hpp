#pragma once

#include <time.h>

#include <algorithm>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <vector>

/// What the benchmarks share: the images, the work to compare with, clocks and the form of a result.
namespace bench
{

/// Frames of a photograph that moves: windows of one larger image, in BGR. Throws std::runtime_error without it.
inline std::vector<cv::Mat> movingImage(const std::string& path, cv::Size size)
{
  constexpr int kFrames = 8;
  constexpr int kStep = 4;  // px from frame to frame
  const cv::Mat photograph = cv::imread(path, cv::IMREAD_COLOR);
  if (photograph.empty()) throw std::runtime_error(path + " is not an image");
  cv::Mat large;
  cv::resize(photograph, large, size + cv::Size(kFrames * kStep, kFrames * kStep), 0, 0, cv::INTER_CUBIC);
  std::vector<cv::Mat> frames;
  for (int i = 0; i < kFrames; ++i)
    frames.push_back(large(cv::Rect(cv::Point(i * kStep, i * kStep), size)).clone());
  return frames;
}

/// Before a camera that stands still: parts of the first frame as boxes that wander from these places (shares of the
/// frame's size), and pixel noise.
inline std::vector<cv::Mat> withBoxes(const std::vector<cv::Mat>& moving, const std::vector<cv::Point2d>& places)
{
  const cv::Mat& behind = moving.front();
  const cv::Size box = behind.size() / 6;
  std::vector<cv::Mat> frames;
  cv::RNG random(1);
  for (std::size_t i = 0; i < moving.size(); ++i)
  {
    cv::Mat frame = behind.clone();
    for (const cv::Point2d& place : places)
    {
      const int moved = static_cast<int>(i) * frame.cols / 32;
      const cv::Point at(cvRound(place.x * frame.cols) + moved, cvRound(place.y * frame.rows));
      behind(cv::Rect({frame.cols / 2, frame.rows / 2}, box)).copyTo(frame(cv::Rect(at, box)));
    }
    cv::Mat noise(frame.size(), CV_16SC3);
    random.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
    cv::add(frame, noise, frames.emplace_back(), cv::noArray(), CV_8U);
  }
  return frames;
}

inline double median(std::vector<double> values)
{
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The bare OpenCV chain. Memory is kept from frame to frame: the least that this work can cost.
class EdgeChain
{
public:
  void apply(const cv::Mat& bgr, cv::Mat& edges)
  {
    cv::cvtColor(bgr, gray_, cv::COLOR_BGR2GRAY);
    cv::blur(gray_, blurred_, {7, 7});
    cv::Canny(blurred_, edges, 15.0, 30.0, 3, false);
  }

private:
  cv::Mat gray_;
  cv::Mat blurred_;
};

/// What a clock shows, in s: CLOCK_MONOTONIC, or the CPU time of a process (CLOCK_PROCESS_CPUTIME_ID, clockOf()).
inline double seconds(clockid_t clock)
{
  timespec time;
  if (clock_gettime(clock, &time) != 0) throw std::runtime_error("the process measured has ended");
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

/// The CPU clock of all threads of another process: what /proc/PID/stat counts, but in ns instead of ticks of 10 ms.
inline clockid_t clockOf(pid_t pid)
{
  clockid_t clock;
  if (clock_getcpuclockid(pid, &clock) != 0) throw std::runtime_error("no process " + std::to_string(pid));
  return clock;
}

struct Result
{
  int sent = 0;
  double seconds = 0.0;      // wall time of the frames counted
  double cpu_seconds = 0.0;  // of the processes measured, in that time
  double begin = 0.0;        // stamps of the first and the last frame counted, in s
  double end = 0.0;
  std::vector<double> latencies_ms;  // of the frames that came through
  double same_pixels = -1.0;         // share of a result's pixels that are as expected; -1: not looked at
};

/// Writes the result as one line of JSON.
inline void print(const Result& result)
{
  std::printf("{\"sent\": %d, \"seconds\": %.6f, \"cpu_seconds\": %.6f, \"same_pixels\": %.6f, ", result.sent,
              result.seconds, result.cpu_seconds, result.same_pixels);
  std::printf("\"begin\": %.9f, \"end\": %.9f, \"latencies_ms\": [", result.begin, result.end);
  const char* comma = "";
  for (const double latency : result.latencies_ms)
  {
    std::printf("%s%.4f", comma, latency);
    comma = ", ";
  }
  std::printf("]}\n");
}

}  // namespace bench
