#include "v4l2_pixel_formats.hpp"

#include "robot_vision/common/range.hpp"

namespace robot_vision
{

const V4l2Format* findV4l2Format(const std::string& name)
{
  for (const V4l2Format& format : kV4l2Formats)
    if (name == format.name) return &format;
  return nullptr;
}

const V4l2Format* findV4l2Format(std::uint32_t fourcc)
{
  for (const V4l2Format& format : kV4l2Formats)
    if (fourcc == format.fourcc) return &format;
  return nullptr;
}

std::string v4l2FormatNames()
{
  std::string names = kV4l2Formats.front().name;
  for (std::size_t i = 1; i < kV4l2Formats.size(); ++i)
    names += (i + 1 < kV4l2Formats.size() ? ", " : " or ") + std::string(kV4l2Formats[i].name);
  return names;
}

std::string fourccText(std::uint32_t fourcc)
{
  std::string text;
  for (int shift = 0; shift < 32; shift += 8)
    text += static_cast<char>(fourcc >> shift & 0x7F);
  return text.substr(0, text.find_last_not_of(' ') + 1);
}

std::string describeFormat(std::uint32_t fourcc, std::uint32_t width, std::uint32_t height)
{
  return fourccText(fourcc) + " " + sizeText(width, height);
}

}  // namespace robot_vision
