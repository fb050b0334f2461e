#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "core/codecs/theora_setup.hpp"
#include "robot_vision/codecs/theora.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

/// A smooth image that moves with `i`.
cv::Mat frameAt(int i, cv::Size size = {70, 50})
{
  return smooth({size.width + 20, size.height})(cv::Rect(i % 20, 0, size.width, size.height)).clone();
}

double difference(const cv::Mat& a, const cv::Mat& b)
{
  return cv::norm(a, b, cv::NORM_L1) / (static_cast<double>(a.total()) * a.channels());
}

/// Decodes packets into `out`; returns how many images came of them.
int decodeAll(TheoraDecoder& decoder, const std::vector<TheoraPacket>& packets, cv::Mat& out)
{
  int decoded = 0;
  for (const TheoraPacket& packet : packets)
    decoded += decoder.decode(packet, out) ? 1 : 0;
  return decoded;
}

bool isHeader(const TheoraPacket& packet)
{
  return (packet.data.at(0) & 0x80) != 0;  // Theora specification, 6.1
}

bool isKeyframe(const TheoraPacket& packet)
{
  return (packet.data.at(0) & 0xC0) == 0;  // and 7.1
}

}  // namespace

TEST(Theora, givesAlmostTheSameImages)
{
  TheoraEncoder encoder({true, 63, 1, 64});
  TheoraDecoder decoder;
  for (int i = 0; i < 5; ++i)
  {
    const cv::Mat image = frameAt(i);
    const cv::Mat before = image.clone();
    cv::Mat back;
    EXPECT_EQ(decodeAll(decoder, encoder.encode(image), back), 1);
    ASSERT_EQ(back.size(), image.size());
    ASSERT_EQ(back.type(), CV_8UC3);
    EXPECT_LT(difference(back, image), 4.0) << i;
    EXPECT_GT(difference(back, frameAt(i + 9)), 12.0);
    EXPECT_TRUE(equal(image, before));
  }
}

TEST(Theora, repeatsTheHeadersWithEveryKeyframe)
{
  TheoraEncoder encoder({true, 31, 1, 4});
  std::vector<int> keyframes;
  std::int64_t number = 2;
  for (int i = 0; i < 9; ++i)
  {
    const std::vector<TheoraPacket> packets = encoder.encode(frameAt(i));
    const TheoraPacket& frame = packets.back();
    EXPECT_FALSE(isHeader(frame));
    EXPECT_EQ(frame.number, ++number);
    ASSERT_EQ(packets.size(), isKeyframe(frame) ? 4u : 1u);
    if (!isKeyframe(frame)) continue;
    keyframes.push_back(i);
    for (int header = 0; header < 3; ++header)
    {
      EXPECT_TRUE(isHeader(packets[header]));
      EXPECT_EQ(packets[header].begins_stream, header == 0);
      EXPECT_EQ(packets[header].number, header);
      EXPECT_EQ(packets[header].data, encoder.headers()[header].data);
    }
  }
  EXPECT_EQ(keyframes, (std::vector<int>{0, 4, 8}));
}

TEST(Theora, canBeJoinedAtAKeyframe)
{
  TheoraEncoder encoder({true, 63, 1, 4});
  TheoraDecoder decoder;
  cv::Mat back;
  std::vector<int> seen;
  for (int i = 0; i < 9; ++i)
  {
    if (i == 6) encoder.requestKeyframe();
    const std::vector<TheoraPacket> packets = encoder.encode(frameAt(i));
    if (i >= 1 && decodeAll(decoder, packets, back) == 1) seen.push_back(i);
    if (i >= 4) EXPECT_LT(difference(back, frameAt(i)), 4.0) << i;
  }
  EXPECT_EQ(seen, (std::vector<int>{4, 5, 6, 7, 8}));
  EXPECT_EQ(encoder.encode(frameAt(9)).size(), 1u);  // the next key frame is due 4 frames after the requested one
  EXPECT_EQ(encoder.encode(frameAt(10)).size(), 4u);
}

TEST(Theora, followsAChangeOfSize)
{
  TheoraEncoder encoder;
  TheoraDecoder decoder;
  cv::Mat back;
  for (const cv::Size size : {cv::Size(70, 50), cv::Size(32, 16), cv::Size(1, 1)})
  {
    decodeAll(decoder, encoder.encode(frameAt(0, size)), back);
    EXPECT_EQ(back.size(), size);
  }
}

TEST(Theora, repeatsAnImageThatHasNotChanged)
{
  TheoraEncoder encoder;
  TheoraDecoder decoder;
  cv::Mat first;
  cv::Mat back;
  decodeAll(decoder, encoder.encode(frameAt(0)), first);
  TheoraPacket none;
  none.number = 4;
  EXPECT_TRUE(decoder.decode(none, back));
  EXPECT_TRUE(equal(back, first));
}

TEST(Theora, keepsToItsBitRate)
{
  const auto bytes = [](int bitrate)
  {
    TheoraEncoder encoder({false, 63, bitrate, 64});
    std::size_t sum = 0;
    for (int i = 0; i < 30; ++i)
      sum += encoder.encode(noise({200, 120}, CV_8UC3)(cv::Rect(i, 0, 160, 120))).back().data.size();
    return sum;
  };
  EXPECT_LT(2 * bytes(200000), bytes(2000000));
}

TEST(Theora, refusesOtherTypesAndParametersOutOfRange)
{
  TheoraEncoder encoder;
  EXPECT_EQ(refusal([&] { encoder.encode(cv::Mat(2, 2, CV_8UC1)); }),
            "an image of 2x2 (CV_8UC1) cannot become Theora, must be CV_8UC3 of 1 to 33554432 pixels");
  EXPECT_EQ(refusal([] { TheoraEncoder({true, 64, 1, 64}); }), "quality is 64, must be from 0 to 63");
  EXPECT_EQ(refusal([] { TheoraEncoder({true, 1, 0, 64}); }), "target_bitrate is 0, must be from 1 to 9.92e+07");
  EXPECT_EQ(refusal([] { TheoraEncoder({true, 1, 1, 65}); }), "keyframe_frequency is 65, must be from 1 to 64");
}

TEST(Theora, refusesAStreamThatWouldFillTheMemory)
{
  TheoraEncoder encoder;
  std::vector<TheoraPacket> packets = encoder.encode(frameAt(0));
  // The numbers of macro blocks across and down (Theora specification, 6.2), for 8192 x 4112 px.
  const std::array<std::uint8_t, 4> blocks = {0x02, 0x00, 0x01, 0x01};
  std::copy(blocks.begin(), blocks.end(), packets[0].data.begin() + 10);
  TheoraDecoder decoder;
  cv::Mat back;
  std::string reason;
  for (const TheoraPacket& packet : packets)
    reason += refusal([&] { decoder.decode(packet, back); });
  EXPECT_NE(reason.find("in frames of 8192x4112, must be of 1 to 33554432 pixels"), std::string::npos) << reason;
}

TEST(Theora, refusesDamagedPackets)
{
  TheoraEncoder encoder;
  const std::vector<TheoraPacket> packets = encoder.encode(frameAt(0));
  TheoraDecoder decoder;
  cv::Mat back;
  TheoraPacket damaged = packets[0];
  damaged.data.resize(20);
  EXPECT_EQ(refusal([&] { decoder.decode(damaged, back); }), "Theora packet of 20 bytes is a damaged header");
  decodeAll(decoder, packets, back);
  EXPECT_FALSE(back.empty());
}

TEST(Theora, recognizesACompleteSetupHeader)
{
  TheoraEncoder encoder;
  const std::vector<std::uint8_t> whole = encoder.encode(frameAt(0)).at(2).data;
  EXPECT_TRUE(isTheoraSetup(whole));
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(isTheoraSetup({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)})) << size;
  std::vector<std::uint8_t> longer = whole;
  longer.push_back(0);
  EXPECT_TRUE(isTheoraSetup(longer));
}

TEST(Theora, refusesADamagedSetupHeaderBeforeTheLibrarySeesIt)
{
  TheoraEncoder encoder;
  const std::vector<TheoraPacket> packets = encoder.encode(frameAt(0));
  const auto size = static_cast<int>(packets[2].data.size());
  int refused = 0;
  for (int bit = 0; bit < 8 * size; bit += 13)
  {
    TheoraPacket setup = packets[2];
    setup.data[bit / 8] ^= static_cast<std::uint8_t>(0x80 >> bit % 8);
    if (setup.data[0] != 0x82) continue;  // is no setup header any more
    TheoraDecoder decoder;
    cv::Mat back;
    decodeAll(decoder, {packets[0], packets[1]}, back);
    const std::string said = refusal([&] { decoder.decode(setup, back); });
    EXPECT_EQ(said, isTheoraSetup(setup.data)
                        ? ""
                        : "Theora packet of " + std::to_string(size) + " bytes is a damaged setup header");
    refused += said.empty() ? 0 : 1;
  }
  EXPECT_GT(refused, 100);  // most flips change a number for which any value is valid
}

TEST(Theora, givesNothingFromALostFrameToTheNextKeyframe)
{
  TheoraEncoder encoder({true, 63, 1, 4});
  TheoraDecoder decoder;
  cv::Mat back;
  std::vector<int> seen;
  for (int i = 0; i < 14; ++i)
  {
    const std::vector<TheoraPacket> packets = encoder.encode(frameAt(i));
    if (i == 1 || i == 8) continue;  // the second one is a keyframe
    if (decodeAll(decoder, packets, back) == 0) continue;
    seen.push_back(i);
    EXPECT_LT(difference(back, frameAt(i)), 4.0) << i;
  }
  EXPECT_EQ(seen, (std::vector<int>{0, 4, 5, 6, 7, 12, 13}));
}

TEST(Theora, refusesAnImageWithoutPixels)
{
  TheoraEncoder encoder;
  std::vector<TheoraPacket> packets = encoder.encode(frameAt(0));
  std::fill_n(packets[0].data.begin() + 14, 3, std::uint8_t{0});  // width (Theora specification, 6.2)
  TheoraDecoder decoder;
  cv::Mat back;
  decodeAll(decoder, {packets.begin(), packets.begin() + 3}, back);
  EXPECT_EQ(refusal([&] { decoder.decode(packets[3], back); }),
            "Theora packet of " + std::to_string(packets[3].data.size()) +
                " bytes belongs to images of 0x50 in frames of 80x64, must be of 1 to 33554432 pixels");
}

TEST(Theora, continuesAtTheNextKeyframeAfterADamagedFrame)
{
  TheoraEncoder encoder({true, 63, 1, 2});
  TheoraDecoder decoder;
  cv::Mat back;
  std::vector<int> seen;
  for (int i = 0; i < 4; ++i)
    for (TheoraPacket packet : encoder.encode(frameAt(i)))
    {
      if (i == 0 && !isHeader(packet)) packet.data = {0x3F, 0x7F};  // a key frame with reserved bits that are set
      bool decoded = false;
      const std::string reason = refusal([&] { decoded = decoder.decode(packet, back); });
      if (decoded) seen.push_back(i);
      EXPECT_TRUE(reason.empty() || i == 0) << i;
    }
  EXPECT_EQ(seen, (std::vector<int>{2, 3}));
  EXPECT_LT(difference(back, frameAt(3)), 4.0);
}
