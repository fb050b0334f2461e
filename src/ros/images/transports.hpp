#pragma once

#include <image_transport/image_transport.h>

#include <string>

namespace robot_vision
{

/// Throws std::invalid_argument naming the installed transports if `transport` ("raw", "compressed") is not among them.
void requireTransport(const image_transport::ImageTransport& it, const std::string& transport);

}  // namespace robot_vision
