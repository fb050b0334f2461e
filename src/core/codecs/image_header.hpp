#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

namespace robot_vision
{

struct ClaimedSize
{
  std::uint64_t width = 0;   // px
  std::uint64_t height = 0;  // px
};

/// The size that the header of an image file claims (PNG, JPEG, BMP, PNM, PAM, PFM, TIFF, WebP or Sun raster). None if
/// the file has another format or a damaged header.
std::optional<ClaimedSize> claimedSize(const unsigned char* data, std::size_t size);

}  // namespace robot_vision
