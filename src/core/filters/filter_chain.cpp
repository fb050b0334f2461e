#include "robot_vision/filters/filter_chain.hpp"

#include <algorithm>
#include <sstream>
#include <stdexcept>

#include "core/image/conversion_buffer.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

/// The encoding in which an operation gets an image of `encoding`.
std::string inputEncoding(const Operation& operation, const std::string& encoding)
{
  const auto& taken = operation.encodings;
  const auto takes = [&](const std::string& name)
  { return std::find(taken.begin(), taken.end(), name) != taken.end(); };
  if (takes(encoding)) return encoding;
  const bool is_gray = encoding == "mono8" || encoding == "mono16" || encoding == "mono10";
  return takes("mono8") && (is_gray || !takes("bgr8")) ? "mono8" : "bgr8";
}

/// What `work` returns; what it throws begins with `name`.
template <class Work>
decltype(auto) named(const std::string& name, const Work& work)
{
  try
  {
    return work();
  }
  catch (const cv::Exception& e)  // whose what() has several lines
  {
    throw std::invalid_argument(name + ": OpenCV says: " + e.err);
  }
  catch (const std::exception& e)
  {
    throw std::invalid_argument(name + ": " + e.what());
  }
}

/// The same pixels, without what is around them: OpenCV's filters would read that of an image that is a part of
/// another.
EncodedImage alone(const EncodedImage& image)
{
  const cv::Mat& pixels = image.pixels;
  return {cv::Mat(pixels.rows, pixels.cols, pixels.type(), pixels.data, pixels.step), image.encoding};
}

void requireSameSize(const cv::Mat& image, const cv::Mat& second)
{
  if (image.size() != second.size())
    throw std::invalid_argument("the other image is " + toText(second.size()) + ", must be " + toText(image.size()) +
                                " as this one");
}

}  // namespace

struct FilterChain::Step
{
  /// Does the operation on an image, and returns the encoding of the result.
  std::string apply(const EncodedImage& image, const EncodedImage& second, cv::Mat& out)
  {
    const std::string taken = inputEncoding(*operation, image.encoding);
    const cv::Mat pixels = buffer.as(taken, image.pixels, image.encoding);
    cv::Mat other;
    if (!operation->second.empty())
    {
      const std::string& wanted = operation->second == "input" ? taken : operation->second;
      other = second_buffer.as(wanted, second.pixels, second.encoding);
      requireSameSize(pixels, other);
    }
    run({pixels, taken, other}, out);
    return operation->output.empty() ? taken : operation->output;
  }

  const Operation* operation = nullptr;
  Operation::Step run;
  ConversionBuffer buffer;
  ConversionBuffer second_buffer;
  cv::Mat result;
};

FilterChain::FilterChain(const std::vector<std::string>& chain, const ParamValues& values)
  : mutex_(std::make_unique<std::mutex>())
{
  if (chain.size() > kMaxSteps)
    throw std::invalid_argument("chain has " + std::to_string(chain.size()) + " operations, must have at most " +
                                std::to_string(kMaxSteps));
  checkValues(values);
  for (const std::string& name : chain)
  {
    steps_.emplace_back();
    const Operation* operation = named("chain", [&] { return &operationNamed(name); });
    const OperationValues complete = completeValues(*operation, values);
    steps_.back().operation = operation;
    steps_.back().run = named(operation->name, [&] { return operation->make(complete); });
  }
}

FilterChain::FilterChain(FilterChain&&) = default;
FilterChain& FilterChain::operator=(FilterChain&&) = default;
FilterChain::~FilterChain() = default;

bool FilterChain::takesSecond() const
{
  return std::any_of(steps_.begin(), steps_.end(), [](const Step& step) { return !step.operation->second.empty(); });
}

std::string FilterChain::apply(const EncodedImage& image, cv::Mat& out, const EncodedImage& second,
                               const OnStep& on_step)
{
  checkPixels(image.pixels, image.encoding);
  if (!second.pixels.empty()) checkPixels(second.pixels, second.encoding);
  const EncodedImage other = alone(second.pixels.empty() ? image : second);
  EncodedImage current = alone(image);
  const std::lock_guard<std::mutex> lock(*mutex_);
  for (std::size_t i = 0; i < steps_.size(); ++i)
  {
    Step& step = steps_[i];
    cv::Mat& result = i + 1 == steps_.size() ? out : step.result;
    current.encoding = named(step.operation->name, [&] { return step.apply(current, other, result); });
    current.pixels = result;
    if (on_step) on_step(i, current);
  }
  if (steps_.empty()) image.pixels.copyTo(out);
  return current.encoding;
}

std::vector<std::string> chainNames(const std::string& text)
{
  std::vector<std::string> names;
  std::istringstream words(text);
  for (std::string part; std::getline(words, part, ',');)
  {
    const std::size_t begin = part.find_first_not_of(" \t");
    if (begin == std::string::npos)
      throw std::invalid_argument("chain is '" + printable(text) + "', must be names with one comma between two");
    names.push_back(part.substr(begin, part.find_last_not_of(" \t") - begin + 1));
  }
  return names;
}

}  // namespace robot_vision
