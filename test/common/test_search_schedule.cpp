#include "core/common/search_schedule.hpp"

#include <gtest/gtest.h>

#include <vector>

using namespace robot_vision;

namespace
{

constexpr double kPeriod = 0.5;  // s
const cv::Size kSize(640, 480);

struct Track
{
  bool isInViewAt(double, const cv::Size& image) const { return in_view && image == kSize; }

  double seen = 0.0;  // s
  bool in_view = true;
};

/// Whether a search is due at a time, s, if the whole image was searched at 10 s.
bool isDueAt(double time, const std::vector<Track>& tracks, double frame_period = 0.03125)
{
  SearchSchedule schedule;
  schedule.begin(10.0, kSize);
  schedule.setSearched();
  schedule.begin(time - frame_period, kSize);
  schedule.begin(time, kSize);
  return schedule.isDue(kPeriod, tracks);
}

}  // namespace

TEST(SearchSchedule, beginsAnewForFramesOfAnotherSizeOrAnEarlierTime)
{
  SearchSchedule schedule;
  EXPECT_TRUE(schedule.begin(10.0, kSize));
  EXPECT_FALSE(schedule.begin(10.1, kSize));
  EXPECT_FALSE(schedule.isFirst());
  EXPECT_TRUE(schedule.begin(10.2, {320, 240}));
  EXPECT_TRUE(schedule.begin(10.2, {320, 240}));  // time stands still
  EXPECT_TRUE(schedule.begin(10.1, {320, 240}));  // time goes back
  EXPECT_TRUE(schedule.isFirst());
}

TEST(SearchSchedule, isDueInAFirstFrameAndAfterAReset)
{
  SearchSchedule schedule;
  schedule.begin(10.0, kSize);
  EXPECT_TRUE(schedule.isDue(kPeriod, std::vector<Track>()));
  schedule.setSearched();
  schedule.begin(10.1, kSize);
  EXPECT_FALSE(schedule.isDue(kPeriod, std::vector<Track>()));
  schedule.reset();
  EXPECT_TRUE(schedule.isDue(kPeriod, std::vector<Track>()));
}

TEST(SearchSchedule, isDueBeforeThePeriodIsOver)
{
  EXPECT_FALSE(isDueAt(10.46875, {}));  // the next frame is still in time
  EXPECT_TRUE(isDueAt(10.5, {}));
  EXPECT_TRUE(isDueAt(10.375, {}, 0.25));
}

TEST(SearchSchedule, isDueSoonerWhenATrackIsLost)
{
  const Track lost{10.05}, old{9.9}, seen{10.25}, out_of_view{10.05, false};
  EXPECT_TRUE(isDueAt(10.25, {seen, lost}));
  EXPECT_FALSE(isDueAt(10.0625, {lost}));  // too soon after the last search
  EXPECT_FALSE(isDueAt(10.25, {old, seen, out_of_view}));
}

TEST(SearchSchedule, keepsTracksForLongerThanASearchTakes)
{
  SearchSchedule schedule;
  const auto keeps = [&schedule](double seen)
  {
    std::vector<Track> tracks = {{seen}};
    schedule.forgetOld(kPeriod, tracks);
    return !tracks.empty();
  };
  schedule.begin(10.0, kSize);
  EXPECT_TRUE(keeps(9.5));
  EXPECT_FALSE(keeps(9.4));
  schedule.startBackground();
  schedule.begin(11.0, kSize);
  EXPECT_EQ(schedule.endBackground(), 10.0);
  EXPECT_TRUE(keeps(8.5));
  EXPECT_FALSE(keeps(8.4));
}
