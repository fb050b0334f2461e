#include "robot_vision/codecs/compressed_depth.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "png.hpp"
#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"
#include "rvl.hpp"

namespace robot_vision
{
namespace
{

constexpr std::int32_t kInverseDepth = 0;

/// Stands in front of the image, in the byte order of the machine, because the standard transport copies it from
/// memory.
struct Header
{
  std::int32_t format = kInverseDepth;
  float numerator = 0.0F;  // a depth z in m is coded as numerator / z + offset
  float offset = 0.0F;
};
static_assert(sizeof(Header) == 12, "the header has no gaps on the wire");

constexpr float kMaxCode = 65535.0F;

Header headerFor(const DepthCompressionParams& params)
{
  const auto depth = static_cast<float>(params.depth_quantization);  // at which a step of the code is 1 m
  Header header;
  header.numerator = depth * (depth + 1.0F);
  header.offset = 1.0F - header.numerator / static_cast<float>(params.depth_max);
  return header;
}

cv::Mat encodeMetres(const cv::Mat& depth, const Header& header, float depth_max)
{
  cv::Mat codes(depth.size(), CV_16UC1);
  for (int y = 0; y < depth.rows; ++y)
  {
    const auto* const from = depth.ptr<float>(y);
    std::transform(from, from + depth.cols, codes.ptr<std::uint16_t>(y),
                   [&](float z) -> std::uint16_t
                   {
                     if (!(z > 0.0F && z < depth_max)) return 0;
                     return static_cast<std::uint16_t>(std::min(header.numerator / z + header.offset, kMaxCode));
                   });
  }
  return codes;
}

void decodeMetres(const cv::Mat& codes, const Header& header, cv::Mat& depth)
{
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  depth.create(codes.size(), CV_32FC1);
  for (int y = 0; y < codes.rows; ++y)
  {
    const auto* const from = codes.ptr<std::uint16_t>(y);
    std::transform(from, from + codes.cols, depth.ptr<float>(y),
                   [&](std::uint16_t code)
                   {
                     const float z = header.numerator / (static_cast<float>(code) - header.offset);
                     return code != 0 && std::isfinite(z) && z > 0.0F ? z : kNone;
                   });
  }
}

}  // namespace

bool isDepth(const std::string& encoding)
{
  return encoding == "16UC1" || encoding == "mono16" || encoding == "32FC1";
}

void compressDepth(const cv::Mat& image, const std::string& encoding, const DepthCompressionParams& params,
                   CompressedImage& out)
{
  validate(params);
  require(isDepth(encoding), "encoding", "'" + printable(encoding) + "'", "16UC1, mono16 or 32FC1");
  const int type = encoding == "32FC1" ? CV_32FC1 : CV_16UC1;
  checkPixels(image, encoding, type);
  Header header;
  cv::Mat codes;
  if (type == CV_32FC1)
  {
    header = headerFor(params);
    codes = encodeMetres(image, header, static_cast<float>(params.depth_max));
  }
  else
  {
    codes = image.clone();
    codes.setTo(0, image > std::min(params.depth_max * 1000.0, 65535.0));
  }
  std::vector<std::uint8_t> stream;
  if (params.format == "rvl")
    encodeRvl(codes, stream);
  else
    encodePng(codes, params.png_level, stream);
  out.format = encoding + "; compressedDepth " + params.format;
  out.data.resize(sizeof(header));
  std::memcpy(out.data.data(), &header, sizeof(header));
  out.data.insert(out.data.end(), stream.begin(), stream.end());
}

std::string decompressDepth(const std::string& format, const unsigned char* data, std::size_t size, cv::Mat& image)
{
  const std::size_t split = format.find(';');
  const std::string codec = split == std::string::npos ? "" : format.substr(split);
  const std::string encoding = format.substr(0, split);
  const bool is_rvl = codec == "; compressedDepth rvl";
  // Older transports, which know PNG only, say less.
  const bool is_png = codec.empty() || codec == "; compressedDepth" || codec == "; compressedDepth png";
  require((is_rvl || is_png) && isDepth(encoding), "format", "'" + printable(format) + "'",
          "16UC1, mono16 or 32FC1 with '; compressedDepth png' or '; compressedDepth rvl'");
  Header header;
  if (size < sizeof(header))
    throw std::invalid_argument("compressed depth of " + std::to_string(size) + " bytes has no whole header");
  std::memcpy(&header, data, sizeof(header));
  data += sizeof(header);
  size -= sizeof(header);
  cv::Mat codes = is_rvl ? decodeRvl(data, size) : decodePng(data, size, cv::IMREAD_UNCHANGED);
  if (codes.type() != CV_16UC1)
    throw std::invalid_argument("compressed depth: expected a PNG of " + describePixels(CV_16UC1) + ", got " +
                                describePixels(codes.type()));
  if (encoding == "32FC1")
    decodeMetres(codes, header, image);
  else
    image = codes;
  return encoding;
}

}  // namespace robot_vision
