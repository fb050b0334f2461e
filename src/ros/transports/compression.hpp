#pragma once

#include <robot_vision/CompressedDepthPublisherConfig.h>
#include <robot_vision/CompressedPublisherConfig.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include "encoded_output.hpp"
#include "robot_vision/codecs/compressed_depth.hpp"
#include "robot_vision/codecs/compressed_image.hpp"

namespace robot_vision
{

/// Convert the settings; throw std::invalid_argument naming the first parameter out of range.
CompressionParams toCompressionParams(const CompressedPublisherConfig& config);
DepthCompressionParams toDepthCompressionParams(const CompressedDepthPublisherConfig& config);

/// Compresses an image. Throws std::invalid_argument if the message is damaged or its encoding cannot be compressed.
sensor_msgs::CompressedImage compressMessage(const sensor_msgs::Image& message, const CompressionParams& params);

/// Compresses a depth image, see isDepth(); throws as compressMessage() does.
sensor_msgs::CompressedImage compressDepthMessage(const sensor_msgs::Image& message,
                                                  const DepthCompressionParams& params);

using CompressedOutput = EncodedOutput<CompressedPublisherConfig, CompressionParams>;
using CompressedDepthOutput = EncodedOutput<CompressedDepthPublisherConfig, DepthCompressionParams>;

}  // namespace robot_vision
