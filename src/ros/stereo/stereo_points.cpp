#include "stereo_points.hpp"

namespace robot_vision
{

sensor_msgs::PointCloud2Ptr StereoPoints::cloud(const std_msgs::Header& header, const RectifiedCamera& left,
                                                const cv::Mat& depth, const cv::Mat& bgr)
{
  const CameraModel camera = rectifiedModel(left);
  const auto is_of = [&camera](const CameraModel& other)
  { return other.width == camera.width && other.height == camera.height && other.K == camera.K; };
  if (!maker_ || !is_of(maker_->camera())) maker_.emplace(camera);
  const auto cloud = pool_.take(depth.size(), /*colored=*/true);
  cloud->header = header;
  cv::Mat points = writablePoints(*cloud);
  maker_->cloud(depth, "32FC1", bgr, points);
  return cloud;
}

}  // namespace robot_vision
