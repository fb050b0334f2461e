#include "robot_vision/histogram/histogram.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <vector>

#include "robot_vision/histogram/histogram_plot.hpp"
#include "robot_vision/histogram/hue_saturation.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

const std::string kSpaceNames[] = {"gray", "bgr", "hsv", "lab", "ycrcb"};
const std::string kEncodings[] = {"bgr8", "rgba8", "mono8", "mono16", "mono10", "bayer_rggb8", "yuv422"};

HistogramParams params(const std::string& space, int bins)
{
  HistogramParams made;
  made.space = space;
  made.bins = bins;
  return made;
}

}  // namespace

TEST(Histogram, countsEveryPixelOfEveryEncodingOnceAndChangesNone)
{
  for (const std::string& encoding : kEncodings)
    for (const std::string& space : kSpaceNames)
    {
      cv::Mat image = noise({38, 26}, matType(encoding), 3);  // with padded rows
      if (encoding == "mono10") image &= cv::Scalar::all(1023);
      const cv::Mat before = image.clone();
      const std::vector<ChannelHistogram> channels = computeHistogram(image, encoding, params(space, 33));
      EXPECT_EQ(channels.size(), space == "gray" ? 1U : 3U);
      for (const ChannelHistogram& channel : channels)
        EXPECT_EQ(std::accumulate(channel.counts.begin(), channel.counts.end(), 0), 38 * 26)
            << encoding << " " << space << " " << channel.name;
      EXPECT_TRUE(equal(image, before));
    }
}

TEST(Histogram, readsNothingOutsideOfARegionInAPaddedImage)
{
  const cv::Mat padded = noise({60, 40}, CV_8UC3, 5);
  const cv::Rect region(13, 7, 31, 20);
  const cv::Mat part = padded(region).clone();
  for (const std::string& space : kSpaceNames)
  {
    const auto of_part = computeHistogram(part, "bgr8", params(space, 64));
    const auto of_region = computeHistogram(padded, "bgr8", params(space, 64), region);
    ASSERT_EQ(of_part.size(), of_region.size());
    for (std::size_t i = 0; i < of_part.size(); ++i)
      EXPECT_EQ(of_part[i].counts, of_region[i].counts) << space;
  }
  EXPECT_TRUE(equal(hueSaturationHistogram(part, "bgr8"), hueSaturationHistogram(padded, "bgr8", {}, region)));
}

TEST(Histogram, drawsIntoImagesOfAnySize)
{
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 40), cv::Size(40, 1), cv::Size(159, 95), cv::Size(641, 481)})
    for (const char* plot : {"over", "beside"})
      for (const char* scale : {"linear", "log"})
      {
        const cv::Mat image = noise(size, CV_8UC3, 2), before = image.clone();
        HistogramPlotParams look;
        look.plot = plot;
        look.scale = scale;
        cv::Mat out;
        plotHistogram(image, computeHistogram(image, "bgr8"), look, out);
        EXPECT_EQ(out.rows, size.height);
        plotHistogram(image, {}, look, out);  // axes without a curve
        EXPECT_TRUE(equal(image, before));
      }
}

TEST(Histogram, projectsBackIntoMemoryThatIsThere)
{
  const cv::Mat image = noise({50, 30}, CV_8UC3, 4);
  const HueSaturationParams params;
  cv::Mat out(30, 50, CV_8UC1);
  const std::uint8_t* memory = out.data;
  backProject(image, "bgr8", hueSaturationHistogram(image, "bgr8"), params, out);
  EXPECT_EQ(out.data, memory);
}

TEST(Histogram, refusesWhatItCannotCount)
{
  EXPECT_EQ(refusal([] { computeHistogram(cv::Mat(), "mono16", params("gray", 8)); }), "mono16 image of 0x0 is empty");
  EXPECT_EQ(refusalWith(&HistogramParams::bins, 1025), "bins is 1025, must be from 1 to 1024");
  EXPECT_EQ(refusal(
                [] {
                  partOf({640, 480}, {600, 400, 50, 50});
                }),
            "region of 50x50 px at (600, 400) is not inside the image of 640x480");
  EXPECT_EQ(refusal([] { compareHistograms(cv::Mat(), cv::Mat(), "correlation"); }),
            "the first histogram is 0x0 bins, must be at least 1x1 bins");
}
