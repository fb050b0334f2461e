#include "robot_vision/filters/brightness.hpp"

#include <cstring>

#include "contests.hpp"

namespace bench
{
namespace
{

constexpr double kGain = 1.2;
constexpr double kOffset = 30.0;

struct State : Results
{
  using Function = void (*)(State& state, const cv::Mat& frame);

  State(const Setup& setup, double gamma, Function by) : frames(setup.frames), by_opencv(by)
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

  void byOpenCv(std::size_t i) { by_opencv(*this, frames[i]); }
  void byUs(std::size_t i) { brightness.apply(frames[i], "bgr8", ours); }
  bool same() const { return by_opencv == copy || Results::same(); }

  static void copy(State& state, const cv::Mat& frame)
  {
    state.theirs.create(frame.size(), frame.type());
    std::memcpy(state.theirs.data, frame.data, frame.total() * frame.elemSize());
  }

  static void convert(State& state, const cv::Mat& frame) { frame.convertTo(state.theirs, -1, kGain, kOffset); }
  static void applyLut(State& state, const cv::Mat& frame) { cv::LUT(frame, state.table, state.theirs); }

  std::vector<cv::Mat> frames;
  Function by_opencv;
  robot_vision::Brightness brightness;
  cv::Mat table;
};

Work work(const char* name, const char* against, double goal, double gamma, State::Function theirs)
{
  return {name, against, goal, contestOf<State>(gamma, theirs), theirs == State::copy && gamma == 1.0};
}

}  // namespace

std::vector<Work> brightnessWorks()
{
  constexpr double kOfMemcpy = 1.0 / 1.3;
  return {work("brightness and contrast", "memcpy", kOfMemcpy, 1.0, State::copy),
          work("brightness, contrast, gamma", "memcpy", kOfMemcpy, 0.7, State::copy),
          work("brightness and contrast", "convertTo", 1.0, 1.0, State::convert),
          work("brightness, contrast, gamma", "LUT", 1.0, 0.7, State::applyLut)};
}

}  // namespace bench
