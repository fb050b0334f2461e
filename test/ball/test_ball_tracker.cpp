#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "robot_vision/ball/ball_tracker.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

const cv::Point2d kStart(100, 300), kVelocity(240, -90);  // px, px/s
const double kFrame = 1.0 / 30.0;                         // s

BallMeasurement straight(double time_s)
{
  return {kStart + kVelocity * time_s, 20.0};
}

/// A tracker that has seen the straight motion from 0 to 1 s.
BallTracker settled(const BallTrackerParams& params = BallTrackerParams())
{
  BallTracker tracker(params);
  for (int frame = 0; frame <= 30; ++frame)
    tracker.update(frame * kFrame, straight(frame * kFrame));
  return tracker;
}

}  // namespace

TEST(BallTracker, beginsWithTheFirstMeasurement)
{
  BallTracker tracker;
  EXPECT_FALSE(tracker.update(5.0, std::nullopt));
  EXPECT_FALSE(tracker.predict(5.0));
  const std::optional<BallState> state = tracker.update(6.0, BallMeasurement{{12.5, 40.0}, 7.0});
  ASSERT_TRUE(state);
  EXPECT_EQ(state->center, cv::Point2d(12.5, 40.0));
  EXPECT_EQ(state->velocity, cv::Point2d(0.0, 0.0));
  EXPECT_EQ(state->radius, 7.0);
  EXPECT_FALSE(state->predicted);
  const BallTrackerParams params;
  EXPECT_NEAR(state->covariance(1, 1), std::pow(params.measurement_noise, 2), 1e-9);
  EXPECT_NEAR(state->covariance(3, 3), std::pow(params.initial_speed, 2), 1e-3);
}

TEST(BallTracker, findsTheVelocityWhateverTheTimeSteps)
{
  BallTracker tracker;
  cv::RNG random(0x5EED);
  double time_s = 0.0;
  std::optional<BallState> state;
  for (int frame = 0; frame < 60; ++frame, time_s += random.uniform(0.005, 0.1))
    state = tracker.update(time_s, straight(time_s));
  EXPECT_LT(cv::norm(state->velocity - kVelocity), 0.001 * cv::norm(kVelocity));
  const std::optional<BallState> later = tracker.predict(time_s + 0.25);
  EXPECT_LT(cv::norm(later->center - straight(time_s + 0.25).center), 0.2);
}

TEST(BallTracker, predictsTheSameInOneStepAndInMany)
{
  BallTracker once = settled(), often = settled();
  for (const double time_s : {1.01, 1.1, 1.1, 1.17})
    often.update(time_s, std::nullopt);
  const std::optional<BallState> a = once.predict(1.3), b = often.predict(1.3);
  EXPECT_LT(cv::norm(a->center - b->center), 1e-9);
  EXPECT_LT(cv::norm(a->covariance - b->covariance), 1e-9 * cv::norm(a->covariance));
}

TEST(BallTracker, hasAConsistentCovariance)
{
  // The truth moves as the model says, in steps of a tenth of a frame. The mean of e' C^-1 e is then the dimension of
  // the state, 4 (Bar-Shalom, 5.4.2), and the standard deviation of the mean of 200 runs is about 0.2.
  const BallTrackerParams params;
  const int runs = 200, frames = 15, pieces = 10;
  cv::RNG random(0x5EED);
  double sum = 0.0;
  for (int run = 0; run < runs; ++run)
  {
    BallTracker tracker;
    cv::Vec4d truth(320, 240, random.gaussian(params.initial_speed), random.gaussian(params.initial_speed));
    std::optional<BallState> state;
    for (int frame = 0; frame < frames; ++frame)
    {
      const cv::Point2d noise(random.gaussian(params.measurement_noise), random.gaussian(params.measurement_noise));
      state = tracker.update(frame * kFrame, BallMeasurement{cv::Point2d(truth[0], truth[1]) + noise, 20.0});
      ASSERT_FALSE(state->predicted);
      if (frame == frames - 1) break;
      for (int piece = 0; piece < pieces; ++piece)
      {
        const double t = kFrame / pieces;
        truth += cv::Vec4d(truth[2], truth[3], 0, 0) * t;
        for (const int rate : {2, 3})
          truth[rate] += random.gaussian(params.process_noise * std::sqrt(t));
      }
    }
    const cv::Vec4d error = cv::Vec4d(state->center.x, state->center.y, state->velocity.x, state->velocity.y) - truth;
    sum += error.dot(state->covariance.inv() * error);
  }
  EXPECT_NEAR(sum / runs, 4.0, 0.7);
}

TEST(BallTracker, predictsThroughAnOcclusion)
{
  BallTracker tracker = settled();
  double uncertainty = 0.0;
  for (const double time_s : {1.1, 1.2, 1.3, 1.4})
  {
    const std::optional<BallState> state = tracker.update(time_s, std::nullopt);
    ASSERT_TRUE(state);
    EXPECT_TRUE(state->predicted);
    EXPECT_LT(cv::norm(state->center - straight(time_s).center), 1.0);
    EXPECT_LT(cv::norm(state->velocity - kVelocity), 1.0);
    EXPECT_NEAR(state->radius, 20.0, 1e-9);
    EXPECT_GT(state->covariance(0, 0), uncertainty);
    uncertainty = state->covariance(0, 0);
  }
  const std::optional<BallState> again = tracker.update(1.45, straight(1.45));
  EXPECT_FALSE(again->predicted);
  EXPECT_LT(cv::norm(again->center - straight(1.45).center), 0.1);
  EXPECT_LT(again->covariance(0, 0), 1.0);
}

TEST(BallTracker, losesTheBallAfterMaxPrediction)
{
  BallTracker tracker = settled();
  EXPECT_TRUE(tracker.update(1.499, std::nullopt));
  EXPECT_FALSE(tracker.predict(1.501));
  EXPECT_TRUE(tracker.predict(1.499));
  EXPECT_FALSE(tracker.expected(1.501));  // it was not seen in the frame before
  EXPECT_FALSE(tracker.update(1.501, std::nullopt));
  EXPECT_FALSE(tracker.update(1.49, std::nullopt));
  const std::optional<BallState> elsewhere = tracker.update(1.6, BallMeasurement{{600, 20}, 9.0});
  ASSERT_TRUE(elsewhere);
  EXPECT_FALSE(elsewhere->predicted);
  EXPECT_EQ(elsewhere->center, cv::Point2d(600, 20));
  EXPECT_EQ(elsewhere->velocity, cv::Point2d(0, 0));
}

TEST(BallTracker, followsABallThatIsSeenInEachFrameHoweverRareTheyAre)
{
  BallTrackerParams params;
  params.max_prediction = 0.0;
  BallTracker tracker(params);
  std::optional<BallState> state;
  for (int i = 0; i < 20; ++i)
    state = tracker.update(0.5 * i, straight(0.5 * i));
  ASSERT_TRUE(state);
  EXPECT_NEAR(state->velocity.x, (straight(1.0).center - straight(0.0).center).x, 1.0);
  EXPECT_FALSE(BallTracker(tracker).update(10.0, std::nullopt));
  EXPECT_FALSE(tracker.predict(10.0));
  EXPECT_LT(cv::norm(tracker.expected(10.0)->center - straight(10.0).center), 1.0);
  EXPECT_FALSE(tracker.expected(12.0));
  const BallMeasurement elsewhere{{600, 20}, 9.0};
  EXPECT_EQ(tracker.update(12.0, elsewhere)->center, elsewhere.center);
}

TEST(BallTracker, predictsNoBallForLongerThanMaxPredictionBecauseOfAnother)
{
  const BallMeasurement elsewhere{{-6000, 20}, 9.0};  // outside of the gate, which is wide after half a second
  for (const double max_prediction : {0.0, 0.3, 0.6})
  {
    BallTrackerParams params;
    params.max_prediction = max_prediction;
    BallTracker tracker(params);
    for (int i = 0; i < 20; ++i)
      tracker.update(0.5 * i, straight(0.5 * i));
    const std::optional<BallState> state = tracker.update(10.0, elsewhere);
    EXPECT_EQ(state->predicted, max_prediction > 0.5) << max_prediction;
    EXPECT_EQ(state->center == elsewhere.center, max_prediction < 0.5) << max_prediction;
  }
}

TEST(BallTracker, ignoresMeasurementsOutsideOfTheGate)
{
  BallTracker tracker = settled(), blind = settled();
  const double time_s = 1.0 + kFrame;
  const BallMeasurement wrong{straight(time_s).center + cv::Point2d(0, 150), 50.0};
  const std::optional<BallState> state = tracker.update(time_s, wrong), expected = blind.update(time_s, std::nullopt);
  EXPECT_TRUE(state->predicted);
  EXPECT_EQ(state->center, expected->center);
  EXPECT_EQ(state->radius, expected->radius);
  EXPECT_FALSE(tracker.update(1.0 + 2 * kFrame, straight(1.0 + 2 * kFrame))->predicted);

  BallTrackerParams tolerant;
  tolerant.gate = 100.0;
  EXPECT_FALSE(settled(tolerant).update(time_s, wrong)->predicted);
}

TEST(BallTracker, hasAGateOfTheGivenWidth)
{
  BallTracker tracker = settled();
  const BallTrackerParams params;
  const std::optional<BallState> expected = tracker.predict(1.1);
  const double spread = std::sqrt(expected->covariance(0, 0) + std::pow(params.measurement_noise, 2));
  for (const double part : {0.99, 1.01})
  {
    const cv::Point2d off(params.gate * spread * part, 0.0);
    EXPECT_EQ(BallTracker(tracker).update(1.1, BallMeasurement{expected->center + off, 20.0})->predicted, part > 1.0);
  }
}

TEST(BallTracker, beginsAnewIfTimeGoesBackwards)
{
  BallTracker tracker = settled();
  EXPECT_FALSE(BallTracker(tracker).update(0.9, std::nullopt));
  const std::optional<BallState> state = tracker.update(0.2, BallMeasurement{{500, 400}, 9.0});
  EXPECT_FALSE(state->predicted);
  EXPECT_EQ(state->center, cv::Point2d(500, 400));
  EXPECT_EQ(tracker.update(0.3, std::nullopt)->center, cv::Point2d(500, 400));
}

TEST(BallTracker, smoothsTheRadius)
{
  BallTracker tracker;
  cv::RNG random(0x5EED);
  double measured_error = 0.0, error = 0.0;
  for (int frame = 0; frame < 300; ++frame)
  {
    const double truth = 30.0 + 2.0 * std::sin(frame * kFrame), noise = random.gaussian(0.5);
    const std::optional<BallState> state = tracker.update(frame * kFrame, BallMeasurement{kStart, truth + noise});
    measured_error += noise * noise;
    error += std::pow(state->radius - truth, 2);
  }
  EXPECT_LT(error, measured_error);
  EXPECT_LT(std::sqrt(error / 300), 0.6);
}

TEST(BallTracker, refusesNumbersThatAreNotFinite)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  BallTracker tracker;
  EXPECT_EQ(refusal([&] { tracker.update(nan, std::nullopt); }), "time_s is nan, must be finite");
  EXPECT_EQ(refusal([&] { tracker.update(0, BallMeasurement{{nan, 1}, 1}); }), "center.x is nan, must be finite");
  EXPECT_EQ(refusal([&] { tracker.update(0, BallMeasurement{{1, nan}, 1}); }), "center.y is nan, must be finite");
  EXPECT_EQ(refusal([&] { tracker.update(0, BallMeasurement{{1, 1}, -2}); }), "radius is -2, must be at least 0 (px)");
}

TEST(BallTracker, refusesParametersOutOfRange)
{
  BallTrackerParams params;
  params.gate = 0.5;
  EXPECT_EQ(refusal([&] { BallTracker{params}; }), "gate is 0.5, must be from 1 to 100");
}
