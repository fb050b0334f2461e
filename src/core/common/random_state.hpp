#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace robot_vision
{

/// Has OpenCV's random numbers of this thread begin at a seed, and puts their state back in the end.
class RandomState
{
public:
  explicit RandomState(int seed) : before_(cv::theRNG().state)
  {
    cv::theRNG() = cv::RNG(static_cast<std::uint64_t>(seed));
  }
  ~RandomState() { cv::theRNG().state = before_; }
  RandomState(const RandomState&) = delete;
  RandomState& operator=(const RandomState&) = delete;

private:
  std::uint64_t before_;
};

}  // namespace robot_vision
