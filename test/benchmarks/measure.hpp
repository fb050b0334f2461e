#pragma once

#include <time.h>

#include <algorithm>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <vector>

/// What the benchmarks share: the pictures, the work to compare with, clocks and the form of a result.
namespace bench
{

/// Frames of a photograph that moves: windows of one larger picture, in BGR. Throws std::runtime_error without it.
inline std::vector<cv::Mat> movingPicture(const std::string& path, cv::Size size)
{
  constexpr int kFrames = 8;
  constexpr int kStep = 4;  // px from frame to frame
  const cv::Mat photograph = cv::imread(path, cv::IMREAD_COLOR);
  if (photograph.empty()) throw std::runtime_error(path + " is not a picture");
  cv::Mat large;
  cv::resize(photograph, large, size + cv::Size(kFrames * kStep, kFrames * kStep), 0, 0, cv::INTER_CUBIC);
  std::vector<cv::Mat> frames;
  for (int i = 0; i < kFrames; ++i)
    frames.push_back(large(cv::Rect(cv::Point(i * kStep, i * kStep), size)).clone());
  return frames;
}

/// Frames of a camera that stands still before a photograph: a part of it wanders as a box, and there is pixel noise.
inline std::vector<cv::Mat> stillPicture(const std::string& path, cv::Size size)
{
  std::vector<cv::Mat> frames = movingPicture(path, size);
  const cv::Mat behind = frames.front().clone();
  const cv::Size box = size / 6;
  cv::RNG random(1);
  for (std::size_t i = 0; i < frames.size(); ++i)
  {
    behind.copyTo(frames[i]);
    const cv::Point at(size.width / 4 + static_cast<int>(i) * size.width / 32, size.height / 3);
    behind(cv::Rect({size.width / 2, size.height / 2}, box)).copyTo(frames[i](cv::Rect(at, box)));
    cv::Mat noise(size, CV_16SC3), noisy;
    random.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
    cv::add(frames[i], noise, noisy, cv::noArray(), CV_8U);
    frames[i] = noisy;
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
