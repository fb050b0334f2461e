#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "robot_vision/tracking/object_tracker.hpp"

inline const cv::Size kImageSize(320, 240);
inline constexpr double kPeriod = 1.0 / 30.0;  // s

/// An image of discs of many sizes, the same for the same seed.
inline cv::Mat blots(const cv::Size& size, int seed)
{
  cv::RNG random(static_cast<std::uint64_t>(seed));
  cv::Mat image(size, CV_8UC3, cv::Scalar::all(128));
  for (int i = 0; i < size.area() / 60; ++i)
  {
    const cv::Point at(random.uniform(0, size.width), random.uniform(0, size.height));
    const cv::Scalar color(random.uniform(0, 256), random.uniform(0, 256), random.uniform(0, 256));
    cv::circle(image, at, random.uniform(1, 9), color, cv::FILLED, cv::LINE_AA);
  }
  return image;
}

inline const cv::Mat kBackground = blots(kImageSize, 1);

/// The background with an object in front of it, whose middle is at `center`, rotated (rad, clockwise) and scaled.
inline cv::Mat with(const cv::Mat& object, const cv::Point2d& center, double scale = 1.0, double angle = 0.0,
                    const cv::Mat& background = kBackground)
{
  const double c = scale * std::cos(angle), s = scale * std::sin(angle);
  const double x = 0.5 * (object.cols - 1), y = 0.5 * (object.rows - 1);
  const cv::Matx23d place(c, -s, center.x - c * x + s * y, s, c, center.y - s * x - c * y);
  cv::Mat image = background.clone();
  cv::warpAffine(object, image, place, image.size(), cv::INTER_LINEAR, cv::BORDER_TRANSPARENT);
  return image;
}

inline const cv::Mat kObject = blots({60, 50}, 2);
inline const cv::Point2d kStart(159.5, 119.5);
inline const cv::Rect kRegion(130, 95, 60, 50);  // the object at kStart

/// A tracker that has selected the object, whose middle is at `center`, in the frame at time 0.
inline robot_vision::ObjectTracker selected(const robot_vision::ObjectTrackerParams& params = {},
                                            const cv::Mat& object = kObject, const cv::Point2d& center = kStart)
{
  robot_vision::ObjectTracker tracker(params);
  tracker.update(0.0, with(object, center), "bgr8");
  const cv::Point corner = center - 0.5 * cv::Point2d(object.cols - 1, object.rows - 1);
  EXPECT_EQ(tracker.select({corner, object.size()}, "thing"), 1);
  return tracker;
}

inline double distance(const cv::Point2d& a, const cv::Point2d& b)
{
  return cv::norm(a - b);
}
