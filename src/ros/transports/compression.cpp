#include "compression.hpp"

#include <utility>

#include "ros/images/image_message.hpp"
#include "ros/params/fields.hpp"

namespace robot_vision
{
namespace
{

sensor_msgs::CompressedImage toMessage(CompressedImage compressed, const std_msgs::Header& header)
{
  sensor_msgs::CompressedImage message;
  message.header = header;
  message.format = std::move(compressed.format);
  message.data = std::move(compressed.data);
  return message;
}

}  // namespace

CompressionParams toCompressionParams(const CompressedPublisherConfig& config)
{
  auto params = filled<CompressionParams>(config);
  params.jpeg = filled<JpegParams>(config);
  validate(params);
  return params;
}

DepthCompressionParams toDepthCompressionParams(const CompressedDepthPublisherConfig& config)
{
  const auto params = filled<DepthCompressionParams>(config);
  validate(params);
  return params;
}

sensor_msgs::CompressedImage compressMessage(const sensor_msgs::Image& message, const CompressionParams& params)
{
  CompressedImage compressed;
  compress(viewAnyPixels(message), message.encoding, params, compressed);
  return toMessage(std::move(compressed), message.header);
}

sensor_msgs::CompressedImage compressDepthMessage(const sensor_msgs::Image& message,
                                                  const DepthCompressionParams& params)
{
  CompressedImage compressed;
  compressDepth(viewAnyPixels(message), message.encoding, params, compressed);
  return toMessage(std::move(compressed), message.header);
}

}  // namespace robot_vision
