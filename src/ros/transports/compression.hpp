#pragma once

#include <robot_vision/CompressedDepthPublisherConfig.h>
#include <robot_vision/CompressedPublisherConfig.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include "encoded_output.hpp"
#include "robot_vision/codecs/compressed_depth.hpp"
#include "robot_vision/codecs/compressed_picture.hpp"

namespace robot_vision
{

/// Throws std::invalid_argument naming the first parameter out of range.
CompressionParams toCompressionParams(const CompressedPublisherConfig& config);
DepthCompressionParams toDepthCompressionParams(const CompressedDepthPublisherConfig& config);

/// Throws std::invalid_argument if the message is damaged, or of an encoding that cannot be compressed.
sensor_msgs::CompressedImage compressMessage(const sensor_msgs::Image& message, const CompressionParams& params);

/// The same for pictures of depths, see isDepth().
sensor_msgs::CompressedImage compressDepthMessage(const sensor_msgs::Image& message,
                                                  const DepthCompressionParams& params);

using CompressedOutput = EncodedOutput<CompressedPublisherConfig, CompressionParams>;
using CompressedDepthOutput = EncodedOutput<CompressedDepthPublisherConfig, DepthCompressionParams>;

}  // namespace robot_vision
