#include "cloud_pool.hpp"

#include <sensor_msgs/PointField.h>

#include <cstdint>
#include <vector>

#include "robot_vision/common/byte_order.hpp"

namespace robot_vision
{
namespace
{

constexpr std::uint32_t kFloat = sizeof(float);

std::vector<sensor_msgs::PointField> fields(bool colored)
{
  std::vector<sensor_msgs::PointField> result;
  for (const char* name : {"x", "y", "z", "rgb"})
  {
    sensor_msgs::PointField field;
    field.name = name;
    field.offset = kFloat * static_cast<std::uint32_t>(result.size());
    field.datatype = sensor_msgs::PointField::FLOAT32;
    field.count = 1;
    result.push_back(field);
  }
  if (!colored) result.pop_back();
  return result;
}

}  // namespace

sensor_msgs::PointCloud2Ptr CloudPool::take(const cv::Size& size, bool colored) const
{
  const sensor_msgs::PointCloud2Ptr cloud = take();
  cloud->width = static_cast<std::uint32_t>(size.width);
  cloud->height = static_cast<std::uint32_t>(size.height);
  cloud->fields = fields(colored);
  cloud->point_step = 4 * kFloat;
  cloud->row_step = cloud->point_step * cloud->width;
  cloud->is_bigendian = !isLittleEndianHost();
  cloud->is_dense = false;
  cloud->data.resize(std::size_t{cloud->row_step} * cloud->height);
  return cloud;
}

cv::Mat writablePoints(sensor_msgs::PointCloud2& cloud)
{
  return {static_cast<int>(cloud.height), static_cast<int>(cloud.width), CV_32FC4, cloud.data.data(), cloud.row_step};
}

}  // namespace robot_vision
