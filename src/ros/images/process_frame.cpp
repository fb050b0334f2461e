#include "process_frame.hpp"

#include <exception>
#include <stdexcept>

namespace robot_vision
{

ProcessFrame::Pixels ProcessFrame::pixels(const std::string& encoding)
{
  Conversion* conversion = nullptr;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    conversion = &conversions_[encoding];
  }
  const std::lock_guard<std::mutex> lock(conversion->mutex);
  if (!conversion->done)
  {
    try
    {
      conversion->pixels = convert(encoding);
    }
    catch (const std::exception& e)
    {
      conversion->refusal = e.what();
    }
    conversion->done = true;
  }
  if (!conversion->refusal.empty()) throw std::invalid_argument(conversion->refusal);
  return conversion->pixels;
}

ProcessFrame::Pixels ProcessFrame::convert(const std::string& encoding) const
{
  if (encoding.empty()) return {viewAnyPixels(*message_), message_};
  sensor_msgs::ImagePtr converted;
  const auto make = [&](cv::Size size)
  {
    converted = pool_.take(size, encoding);
    return writablePixels(*converted);
  };
  const cv::Mat image = convertPixels(*message_, encoding, make);
  if (image.u != nullptr) return {image, nullptr};
  if (converted) return {image, converted};
  return {image, message_};
}

}  // namespace robot_vision
