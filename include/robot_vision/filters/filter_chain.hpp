#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/filters/operations.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{

/// Operations on an image, one after the other. Buffers are kept from image to image. Threads may share one;
/// their calls wait for each other.
class FilterChain
{
public:
  static constexpr std::size_t kMaxSteps = 32;

  /// Called with the index of a step, and its result, which is valid until the function returns. It must not use the
  /// chain.
  using OnStep = std::function<void(std::size_t step, const EncodedImage& result)>;

  /// `chain` names operations; one that occurs several times has the same parameters each time. An empty chain changes
  /// nothing. `values` are parameters as checkValues() takes them. Throws std::invalid_argument as it does, for
  /// names of operations that there are none of, and for more than kMaxSteps.
  explicit FilterChain(const std::vector<std::string>& chain, const ParamValues& values = {});
  FilterChain(FilterChain&&);
  FilterChain& operator=(FilterChain&&);
  ~FilterChain();

  /// Whether an operation of the chain works on two images.
  bool takesSecond() const;

  /// Writes the result into `out` (reused if it fits) and returns its encoding. `image` is not modified. Operations on
  /// two images take `second` as the other one, or `image` if that is empty. Of an image that is a part of another one
  /// nothing around it is seen. Throws std::invalid_argument if an image is not of its encoding, and, naming the
  /// operation, if one cannot be done on it, or would take many seconds.
  std::string apply(const EncodedImage& image, cv::Mat& out, const EncodedImage& second = {},
                    const OnStep& on_step = nullptr);

private:
  struct Step;
  std::vector<Step> steps_;
  std::unique_ptr<std::mutex> mutex_;  // guards the buffers of the steps; held during apply()
};

/// The names in a text such as "gaussian, canny"; none in an empty one. Throws std::invalid_argument for one with
/// nothing between two commas.
std::vector<std::string> chainNames(const std::string& text);

}  // namespace robot_vision
