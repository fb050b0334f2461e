#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <random>

#include "robot_vision/codecs/compressed_depth.hpp"
#include "robot_vision/codecs/compressed_image.hpp"
#include "robot_vision/codecs/theora.hpp"
#include "support/images.hpp"

using namespace robot_vision;

namespace
{

constexpr int kRounds = 400;

/// Damages streams as cables, disks and attackers do, in the same way in every run.
class Damage
{
public:
  Bytes operator()(Bytes bytes)
  {
    const int changes = number(1, 8);
    for (int i = 0; i < changes && !bytes.empty(); ++i)
      change(bytes);
    return bytes;
  }

  int number(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }

private:
  void change(Bytes& bytes)
  {
    const auto at = bytes.begin() + number(0, static_cast<int>(bytes.size()) - 1);
    const auto rest = static_cast<int>(bytes.end() - at);
    switch (number(0, 5))
    {
      case 0:
        *at ^= static_cast<std::uint8_t>(1 << number(0, 7));
        break;
      case 1:
        *at = static_cast<std::uint8_t>(number(0, 255));
        break;
      case 2:
        *at = 0xFF;
        break;
      case 3:
        bytes.erase(at, at + std::min(rest, number(1, 30)));
        break;
      case 4:
        bytes.insert(at, static_cast<std::size_t>(number(1, 30)), static_cast<std::uint8_t>(number(0, 255)));
        break;
      default:
        if (number(0, 3) == 0) bytes.erase(at, bytes.end());
    }
  }

  std::mt19937 random_{0x5EED};  // NOLINT: the same damage every time
};

/// Whether `decode` did not throw. The message of what it throws must be one line.
template <class Decode>
bool survives(Decode decode)
{
  try
  {
    decode();
    return true;
  }
  catch (const std::invalid_argument& e)
  {
    const std::string what = e.what();
    EXPECT_FALSE(what.empty());
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    return false;
  }
}

CompressedImage compressed(const cv::Mat& image, const std::string& encoding, const std::string& format,
                           bool progressive = false)
{
  CompressionParams params;
  params.format = format;
  params.jpeg.progressive = progressive;
  CompressedImage coded;
  compress(image, encoding, params, coded);
  return coded;
}

}  // namespace

TEST(DamagedStreams, ofJpegAndPngAreReadOrRefused)
{
  const cv::Mat image = noise({40, 30}, CV_8UC3);
  Damage damage;
  for (const CompressedImage& whole :
       {compressed(image, "bgr8", "jpeg"), compressed(image, "rgb8", "jpeg", /*progressive=*/true),
        compressed(noise({40, 30}, CV_16UC1), "mono16", "png"), compressed(image, "rgb8", "png")})
  {
    int refused = 0;
    for (int i = 0; i < kRounds; ++i)
    {
      const Bytes data = damage(whole.data);
      const auto mode = static_cast<ColorMode>(damage.number(0, 2));
      cv::Mat out;
      const auto decode = [&]
      { decompress(whole.format, data.data(), data.size(), mode, 1 << damage.number(0, 3), out); };
      if (survives(decode))
        EXPECT_FALSE(out.empty());
      else
        ++refused;
    }
    EXPECT_GT(refused, kRounds / 10) << whole.format;
  }
}

TEST(DamagedStreams, withWrongLabelsAreReadOrRefused)
{
  const Bytes jpeg = compressed(smooth({40, 30}), "bgr8", "jpeg").data;
  const Bytes png = compressed(smooth({40, 30}), "bgr8", "png").data;
  cv::Mat out;
  for (const char* label :
       {"mono8", "bgr8", "rgba8", "mono16", "bgra16", "bayer_rggb8", "yuv422", "16UC3", "32FC1", ";"})
    for (const char* codec : {"; jpeg compressed ", "; png compressed bgr16", "; theora", ";", ""})
      for (const Bytes& data : {jpeg, png, Bytes{}, Bytes(3, 0xFF)})
        if (survives(
                [&]
                { decompress(label + std::string(codec), data.data(), data.size(), ColorMode::kUnchanged, 1, out); }))
          EXPECT_EQ(out.size(), cv::Size(40, 30));
}

TEST(DamagedStreams, ofDepthAreReadOrRefused)
{
  Damage damage;
  for (const std::string codec : {"png", "rvl"})
  {
    DepthCompressionParams params;
    params.format = codec;
    CompressedImage whole;
    compressDepth(noise({40, 30}, CV_16UC1), "16UC1", params, whole);
    int refused = 0;
    for (int i = 0; i < kRounds; ++i)
    {
      const Bytes data = damage(whole.data);
      const std::string format = (i % 2 == 0 ? "32FC1" : "16UC1") + ("; compressedDepth " + codec);
      cv::Mat out;
      refused += survives([&] { decompressDepth(format, data.data(), data.size(), out); }) ? 0 : 1;
    }
    EXPECT_GT(refused, kRounds / 10) << codec;
  }
}

TEST(DamagedStreams, ofTheoraAreReadOrRefused)
{
  Damage damage;
  TheoraEncoder encoder({true, 31, 1, 4});
  TheoraDecoder decoder;
  cv::Mat out;
  int decoded = 0;
  int refused = 0;
  for (int i = 0; i < kRounds; ++i)
  {
    cv::Mat image = smooth({80, 48})(cv::Rect(i % 16, 0, 64, 48));
    for (TheoraPacket packet : encoder.encode(image))
    {
      if (damage.number(0, 5) == 0) packet.data = damage(packet.data);
      if (damage.number(0, 40) == 0) packet.begins_stream = !packet.begins_stream;
      if (!survives([&] { decoded += decoder.decode(packet, out) ? 1 : 0; })) ++refused;
    }
  }
  EXPECT_GT(decoded, kRounds / 10);
  EXPECT_GT(refused, kRounds / 50);
}
