#include "robot_vision/segmentation/segmenter.hpp"

#include <gtest/gtest.h>

#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

const char* const kMethods[] = {"watershed", "grab_cut", "k_means", "mean_shift", "flood_fill", "distance_transform"};

/// Parameters that leave out nothing.
SegmenterParams paramsOf(const std::string& method, double scale)
{
  SegmenterParams params;
  params.method = method;
  params.scale = scale;
  params.min_area = 0.0;
  params.max_segments = 1000;
  return params;
}

/// Adds seeds in the corners of images and beyond them.
void addSeeds(Segmenter& segmenter)
{
  segmenter.addRegion({-3, -2, 8, 7});
  segmenter.addRegion({1000, 1000, 5, 5});
  segmenter.addPoint({36, 22});
  segmenter.addPoint({0, 40});
}

}  // namespace

TEST(Segmenter, takesNoiseOfAnySizeWithPaddedRows)
{
  for (const std::string method : kMethods)
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(37, 23), cv::Size(2, 41), cv::Size(64, 3)})
      for (const double scale : {1.0, 0.37})
        for (const std::string encoding : {"bgr8", "mono16", "bgra8"})
        {
          SCOPED_TRACE(method + " " + encoding + " " + std::to_string(size.width));
          const cv::Mat image = noise(size, matType(encoding), 5), before = image.clone();
          Segmenter segmenter(paramsOf(method, scale));
          addSeeds(segmenter);
          for (int frame = 0; frame < 2; ++frame)
          {
            const Segmentation found = segmenter.apply(image, encoding);
            EXPECT_EQ(found.labels.size(), size);
            EXPECT_EQ(found.labels.type(), CV_16UC1);
            double highest = 0.0;
            cv::minMaxLoc(found.labels, nullptr, &highest);
            EXPECT_LE(highest, 1000.0);
            cv::Mat bgr, painted;
            toBgr(image, encoding, bgr);
            paintSegments(bgr, found.labels, {}, painted);
            drawSeeds(painted, segmenter.seeds());
            EXPECT_EQ(painted.size(), size);
          }
          EXPECT_TRUE(equal(image, before));
        }
}

TEST(Segmenter, measuresAllPixelsOfEachSegment)
{
  const cv::Mat image = smooth({120, 90});
  for (const std::string method : kMethods)
  {
    SCOPED_TRACE(method);
    Segmenter segmenter(paramsOf(method, 1.0));
    addSeeds(segmenter);
    const cv::Mat labels = segmenter.apply(image, "bgr8").labels;
    double sum = 0.0;
    for (const Segment& segment : findSegments(labels))
    {
      EXPECT_EQ(segment.region.area, cv::countNonZero(labels == segment.label));
      EXPECT_TRUE(segment.region.box.contains(cv::Point(segment.region.center)));
      sum += segment.region.area;
    }
    EXPECT_EQ(sum, cv::countNonZero(labels));
    EXPECT_GT(sum, 0.0);
  }
}

TEST(Segmenter, keepsItsParametersWhenOthersAreRefused)
{
  Segmenter segmenter(paramsOf("flood_fill", 1.0));
  addSeeds(segmenter);
  SegmenterParams params;
  params.peak_height = 0.0;
  EXPECT_EQ(refusal([&] { segmenter.configure(params); }), "peak_height is 0, must be from 0.05 to 1");
  EXPECT_EQ(segmenter.seeds().size(), 4U);
  const cv::Mat black = cv::Mat::zeros(20, 30, CV_8UC1);
  EXPECT_EQ(cv::countNonZero(segmenter.apply(black, "mono8").labels), 20 * 30);  // filled, as the method is the old one
}
