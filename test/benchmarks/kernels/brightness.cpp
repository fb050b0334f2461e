#include "robot_vision/filters/brightness.hpp"

#include <cstring>
#include <memory>

#include "contests.hpp"

namespace bench
{
namespace
{

constexpr double kGain = 1.2;
constexpr double kOffset = 30.0;

struct State
{
  State(const Setup& setup, double gamma) : frames(setup.frames)
  {
    robot_vision::BrightnessParams params;
    params.gain = kGain;
    params.offset = kOffset;
    params.gamma = gamma;
    params.threads = setup.threads;
    brightness = robot_vision::Brightness(params);
    cv::Mat ramp(1, 256, CV_8UC1);
    for (int i = 0; i < 256; ++i)
      ramp.at<std::uint8_t>(i) = static_cast<std::uint8_t>(i);
    brightness.apply(ramp, "mono8", table);
  }

  std::vector<cv::Mat> frames;
  robot_vision::Brightness brightness;
  cv::Mat table;
  Results results;
};

using Theirs = void (*)(State& state, const cv::Mat& frame);

void copy(State& state, const cv::Mat& frame)
{
  state.results.theirs.create(frame.size(), frame.type());
  std::memcpy(state.results.theirs.data, frame.data, frame.total() * frame.elemSize());
}

void convert(State& state, const cv::Mat& frame)
{
  frame.convertTo(state.results.theirs, -1, kGain, kOffset);
}

void applyLut(State& state, const cv::Mat& frame)
{
  cv::LUT(frame, state.table, state.results.theirs);
}

Work work(const char* name, const char* against, double goal, double gamma, Theirs theirs)
{
  const auto prepare = [=](const Setup& setup)
  {
    const auto state = std::make_shared<State>(setup, gamma);
    const auto ours = [state](std::size_t i)
    { state->brightness.apply(state->frames[i], "bgr8", state->results.ours); };
    return Contest{[=](std::size_t i) { theirs(*state, state->frames[i]); }, ours,
                   [=] { return theirs == copy || state->results.same(); }};
  };
  return {name, against, goal, prepare, theirs == copy && gamma == 1.0};
}

}  // namespace

std::vector<Work> brightnessWorks()
{
  constexpr double kOfMemcpy = 1.0 / 1.3;
  return {work("brightness and contrast", "memcpy", kOfMemcpy, 1.0, copy),
          work("brightness, contrast, gamma", "memcpy", kOfMemcpy, 0.7, copy),
          work("brightness and contrast", "convertTo", 1.0, 1.0, convert),
          work("brightness, contrast, gamma", "LUT", 1.0, 0.7, applyLut)};
}

}  // namespace bench
