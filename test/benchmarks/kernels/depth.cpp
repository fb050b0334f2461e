#include <algorithm>
#include <cstdint>
#include <opencv2/core/affine.hpp>
#include <opencv2/imgproc.hpp>

#include "contests.hpp"
#include "depth_frames.hpp"
#include "robot_vision/depth/depth_registration.hpp"

namespace bench
{
namespace
{

using robot_vision::CameraModel;

CameraModel pinhole(const cv::Size& size)
{
  const double f = kFocalLength * size.width / kDepthSize.width;
  return {size.width, size.height, {f, 0, 0.5 * size.width, 0, f, 0.5 * size.height, 0, 0, 1}, {}, "plumb_bob"};
}

/// A wall, a floor and boxes that wander, 16UC1.
cv::Mat depthFrame(int number)
{
  cv::Mat depth(kDepthSize, CV_16UC1);
  for (int y = 0; y < depth.rows; ++y)
  {
    const double floor = 0.6 * kFocalLength / std::max(1.0, y - 0.5 * depth.rows);  // m, 0.6 m below the camera
    depth.row(y).setTo(cv::Scalar(std::min(3.5, floor) * 1000.0));
  }
  for (int i = 0; i < 6; ++i)
  {
    const cv::Point corner((97 * i + 5 * number) % 560, (61 * i + 3 * number) % 400);
    cv::rectangle(depth, cv::Rect(corner, cv::Size(60 + 5 * i, 80)), cv::Scalar(900 + 200 * i), cv::FILLED);
  }
  return depth;
}

/// What depth_image_proc/register does: each pixel's point, moved, lands in one pixel of the color image, or with
/// `fill` in the rectangle between where two corners of the depth pixel land; the nearest one stays.
class PlainRegistration
{
public:
  PlainRegistration(const CameraModel& from, const CameraModel& to, const cv::Affine3d& move, bool fill)
    : from_(from), to_(to), move_(move), fill_(fill)
  {
  }

  void apply(const cv::Mat& depth, cv::Mat& registered) const
  {
    registered.create(to_.height, to_.width, CV_16UC1);
    registered.setTo(0);
    for (int v = 0; v < depth.rows; ++v)
      for (int u = 0; u < depth.cols; ++u)
      {
        const double z = depth.at<std::uint16_t>(v, u) * 0.001;
        if (z > 0.0) put(u, v, z, registered);
      }
  }

private:
  struct Landed
  {
    int u, v;
    double z;
  };

  Landed land(double u, double v, double z) const
  {
    const cv::Vec3d at((u - from_.K(0, 2)) * z / from_.K(0, 0), (v - from_.K(1, 2)) * z / from_.K(1, 1), z);
    const cv::Vec3d moved = move_.rotation() * at + move_.translation();
    const double inverse = 1.0 / moved[2];
    return {static_cast<int>(to_.K(0, 0) * moved[0] * inverse + to_.K(0, 2) + 0.5),
            static_cast<int>(to_.K(1, 1) * moved[1] * inverse + to_.K(1, 2) + 0.5), moved[2]};
  }

  void put(int u, int v, double z, cv::Mat& registered) const
  {
    const Landed first = fill_ ? land(u - 0.5, v - 0.5, z) : land(u, v, z);
    const Landed last = fill_ ? land(u + 0.5, v + 0.5, z) : first;
    if (first.u < 0 || first.v < 0 || last.u >= registered.cols || last.v >= registered.rows) return;
    const auto mm = static_cast<std::uint16_t>(0.5 * (first.z + last.z) * 1000.0 + 0.5);
    for (int y = first.v; y <= last.v; ++y)
      for (int x = first.u; x <= last.u; ++x)
      {
        auto& there = registered.at<std::uint16_t>(y, x);
        if (there == 0 || there > mm) there = mm;
      }
  }

  CameraModel from_, to_;
  cv::Affine3d move_;
  bool fill_;
};

std::vector<cv::Mat> depthFrames(std::size_t count)
{
  std::vector<cv::Mat> frames;
  for (std::size_t i = 0; i < count; ++i)
    frames.push_back(depthFrame(static_cast<int>(i)));
  return frames;
}

robot_vision::RegistrationParams withThreads(int threads)
{
  robot_vision::RegistrationParams params;
  params.threads = threads;
  return params;
}

/// A depth image of 640x480 for a color camera with images of the size that is measured.
struct RegistrationState
{
  RegistrationState(const Setup& setup, bool fill)
    : frames(depthFrames(setup.frames.size())),
      move(cv::Vec3d(0.002, -0.005, 0.003), cv::Vec3d(-0.025, 0.001, 0.002)),
      plain(pinhole(kDepthSize), pinhole(setup.frames.front().size()), move, fill),
      registration(pinhole(kDepthSize), pinhole(setup.frames.front().size()), move, withThreads(setup.threads))
  {
  }

  void byOpenCv(std::size_t i) { plain.apply(frames[i], theirs); }
  void byUs(std::size_t i) { registration.apply(frames[i], "16UC1", ours); }

  /// Of the pixels that both have, nearly all are alike; and we have at least as many.
  bool same() const
  {
    cv::Mat difference;
    cv::absdiff(theirs, ours, difference);
    const cv::Mat both = (theirs > 0) & (ours > 0), alike = both & (difference < 50);
    return cv::countNonZero(alike) > 0.95 * cv::countNonZero(both) &&
           cv::countNonZero(ours) > 0.98 * cv::countNonZero(theirs);
  }

  std::vector<cv::Mat> frames;
  cv::Affine3d move;
  PlainRegistration plain;
  robot_vision::DepthRegistration registration;
  cv::Mat theirs, ours;
};

}  // namespace

std::vector<Work> depthWorks()
{
  return {{"registration of depth, 640x480", "the algorithm of depth_image_proc/register", 0.8,
           contestOf<RegistrationState>(false)},
          {"registration of depth, 640x480, filled", "the same with fill_upsampling_holes", 1.5,
           contestOf<RegistrationState>(true)}};
}

}  // namespace bench
