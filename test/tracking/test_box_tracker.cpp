#include "robot_vision/tracking/box_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "core/tracking/box_association.hpp"
#include "core/tracking/box_motion.hpp"
#include "core/tracking/frame_warps.hpp"

using namespace robot_vision;

namespace
{

Warp randomWarp(cv::RNG& random)
{
  const double angle = random.uniform(-0.1, 0.1), scale = random.uniform(0.9, 1.1);
  const double a = scale * std::cos(angle), b = scale * std::sin(angle);
  return {a, -b, random.uniform(-9.0, 9.0), b, a, random.uniform(-9.0, 9.0)};
}

BoxDetection sure(double x)
{
  return {0, 0.9, {x, 50.0, 40.0, 60.0}};
}

}  // namespace

TEST(BoxAssociation, OverlapIsThatOfAreas)
{
  const cv::Rect2d box(0, 0, 10, 10);
  EXPECT_DOUBLE_EQ(overlap(box, box), 1.0);
  EXPECT_DOUBLE_EQ(overlap(box, {5, 0, 10, 10}), 50.0 / 150.0);
  EXPECT_DOUBLE_EQ(overlap(box, {2, 3, 4, 5}), 0.2);
  EXPECT_EQ(overlap(box, {10, 0, 10, 10}), 0.0);
  EXPECT_EQ(overlap(box, {20, 20, 1, 1}), 0.0);
  EXPECT_EQ(overlap(box, {5, 5, 0, 0}), 0.0);
}

TEST(BoxAssociation, TakesPairsOutOfBothLists)
{
  const cv::Rect2d left(0, 0, 10, 10), right(50, 0, 10, 10);
  std::vector<BoxCandidate> tracks = {{4, 0, left, 1}, {5, 0, right, 1}, {6, 1, left, 1}};
  std::vector<BoxCandidate> found = {
      {7, 0, {100, 0, 10, 10}, 1}, {8, 0, {51, 0, 10, 10}, 1}, {9, 0, {1, 0, 10, 10}, 1}};
  const auto pairs = takePairs(tracks, found, {0.5, 5.0, false});
  EXPECT_EQ(pairs, (std::vector<std::pair<std::size_t, std::size_t>>{{4, 9}, {5, 8}}));
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_EQ(tracks[0].index, 6U);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].index, 7U);
}

TEST(BoxAssociation, APairThatOverlapsByJustTheLeastIsOne)
{
  const PairRules rules{0.5, 5.0, false};
  std::vector<BoxCandidate> tracks = {{0, 0, {0, 0, 10, 10}, 1}}, found = {{0, 0, {0, 0, 10, 5}, 1}};
  EXPECT_EQ(takePairs(tracks, found, rules).size(), 1U);
  tracks = {{0, 0, {0, 0, 10, 10}, 1}}, found = {{0, 0, {0, 0, 10, 4.99}, 1}};
  EXPECT_EQ(takePairs(tracks, found, rules).size(), 0U);
}

TEST(BoxAssociation, WhatOverlapsLittleMustBeWhereItIsExpected)
{
  const PairRules rules{0.2, 5.0, false};
  for (const double variance : {0.4, 0.6})  // the centres are 5 apart: five times the root of 0.5 + 0.5
  {
    std::vector<BoxCandidate> tracks = {{0, 0, {0, 0, 10, 10}, variance}}, found = {{0, 0, {5, 0, 10, 10}, 0.5}};
    EXPECT_EQ(takePairs(tracks, found, rules).size(), variance > 0.5 ? 1U : 0U);
  }
  std::vector<BoxCandidate> tracks = {{0, 0, {0, 0, 10, 10}, 0}}, found = {{0, 0, {3, 0, 10, 10}, 0}};
  EXPECT_EQ(takePairs(tracks, found, rules).size(), 1U);
}

TEST(FrameWarps, AreThoseOfAllFramesOneAfterTheOther)
{
  cv::RNG random(3);
  std::vector<Warp> warps;
  FrameWarps frames;
  frames.start(0.0);
  for (int i = 1; i <= 100; ++i)
  {
    warps.push_back(randomWarp(random));
    ASSERT_TRUE(frames.add(i, warps.back()));
  }
  const cv::Point2d point(30.0, -40.0);
  const auto followed = [&](std::size_t from, std::size_t to)
  {
    cv::Point2d moved = point;
    for (std::size_t i = from; i < to; ++i)
      moved = warped(warps[i], moved);
    return moved;
  };
  EXPECT_LT(cv::norm(warped(frames.toNewest(), point) - followed(0, warps.size())), 1e-6);
  EXPECT_LT(cv::norm(warped(frames.moveOrigin(40.5), point) - followed(0, 40)), 1e-6);
  EXPECT_EQ(frames.origin(), 40.5);
  EXPECT_LT(cv::norm(warped(frames.toNewest(), point) - followed(40, warps.size())), 1e-6);
  EXPECT_LT(cv::norm(warped(frames.moveOrigin(41.0), point) - followed(40, 41)), 1e-6);
}

TEST(FrameWarps, ManyFramesWithoutAResultNeedNoMoreRoomAndLoseNoMotion)
{
  FrameWarps frames;
  frames.start(0.0);
  for (int i = 1; i <= 5000; ++i)
    ASSERT_TRUE(frames.add(i, Warp(1, 0, 1, 0, 1, 0)));
  EXPECT_EQ(warped(frames.toNewest(), {0, 0}), cv::Point2d(5000, 0));
  EXPECT_EQ(warped(frames.moveOrigin(4900.0), {0, 0}), cv::Point2d(4900, 0));
  EXPECT_EQ(warped(frames.toNewest(), {0, 0}), cv::Point2d(100, 0));
}

TEST(PairFilter, IsAsSureAfterManyStepsAsAfterOne)
{
  PairFilter once{{3.0, 4.0}, {-1.0, 2.0}, 5.0, 1.0, 2.0}, often = once;
  once.predict(0.7, 3.0);
  for (int i = 0; i < 7; ++i)
    often.predict(0.1, 3.0);
  EXPECT_LT(cv::norm(once.value - often.value), 1e-12);
  EXPECT_NEAR(once.value_variance, often.value_variance, 1e-12);
  EXPECT_NEAR(once.covariance, often.covariance, 1e-12);
  EXPECT_NEAR(once.rate_variance, often.rate_variance, 1e-12);
}

TEST(BoxTracker, IdsGoOnAfterClear)
{
  BoxTracker tracker;
  for (int i = 0; i < 3; ++i)
    tracker.update(0.1 * i, {sure(10.0)});
  EXPECT_EQ(tracker.predict(0.25).at(0).id, 1);
  tracker.clear();
  EXPECT_TRUE(tracker.predict(0.3).empty());
  tracker.update(0.4, {sure(10.0)});
  EXPECT_EQ(tracker.update(0.5, {sure(10.0)}).at(0).id, 2);
}

TEST(BoxTracker, NewParametersKeepTheTracks)
{
  BoxTracker tracker;
  tracker.update(0.0, {sure(10.0)});
  tracker.update(0.1, {sure(10.0)});
  BoxTrackerParams params;
  params.high_score = 0.95;
  tracker.configure(params);
  EXPECT_EQ(tracker.update(0.2, {sure(10.0), sure(300.0)}).at(0).id, 1);
  EXPECT_EQ(tracker.update(0.3, {sure(10.0), sure(300.0)}).size(), 1U);
}

TEST(BoxTracker, AnyCallsGiveFiniteBoxesAndIdsThatGrow)
{
  cv::RNG random(11);
  BoxTracker tracker;
  std::int64_t newest = 0;
  double time = 0.0;
  for (int call = 0; call < 5000; ++call)
  {
    const int kind = random.uniform(0, 8);
    if (kind < 6) time += random.uniform(0.0, 0.1);
    if (call % 500 == 0) time += random.uniform(-5.0, 5.0);
    std::vector<BoxDetection> detections;
    for (int i = random.uniform(0, 6); i > 0; --i)
    {
      const double x = 60.0 * i + random.gaussian(2.0), size = std::exp(random.uniform(-3.0, 5.0));
      detections.push_back({i % 2, random.uniform(0.0, 1.0), {x, 50.0, i > 2 ? 40.0 : size, i > 3 ? 60.0 : size}});
    }
    const std::vector<BoxTrack> tracks = kind < 4    ? tracker.predict(time, randomWarp(random))
                                         : kind == 4 ? tracker.update(time - 0.05, detections)
                                                     : tracker.update(time, detections);
    for (const BoxTrack& track : tracks)
    {
      ASSERT_TRUE(std::isfinite(track.box.x + track.box.y + track.velocity.x + track.velocity.y));
      ASSERT_GT(track.box.width, 0.0);
      ASSERT_GT(track.box.height, 0.0);
      ASSERT_LT(track.detection, static_cast<int>(detections.size()));
      ASSERT_GT(track.id, 0);
    }
    for (std::size_t i = 1; i < tracks.size(); ++i)
      ASSERT_LT(tracks[i - 1].id, tracks[i].id);
    if (!tracks.empty()) newest = std::max(newest, tracks.back().id);
  }
  EXPECT_GT(newest, 10);
}
