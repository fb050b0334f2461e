#include "detections.hpp"

namespace robot_vision
{

Detection toDetection(const Region& region, const std::string& label, int id, double score)
{
  Detection message;
  message.label = label;
  message.id = id;
  message.score = static_cast<float>(score);
  message.box.x_offset = static_cast<std::uint32_t>(region.box.x);
  message.box.y_offset = static_cast<std::uint32_t>(region.box.y);
  message.box.width = static_cast<std::uint32_t>(region.box.width);
  message.box.height = static_cast<std::uint32_t>(region.box.height);
  message.center.x = region.center.x;
  message.center.y = region.center.y;
  message.outline.resize(region.outline.size());
  for (std::size_t i = 0; i < region.outline.size(); ++i)
  {
    message.outline[i].x = static_cast<float>(region.outline[i].x);
    message.outline[i].y = static_cast<float>(region.outline[i].y);
  }
  message.circle_center.x = region.circle_center.x;
  message.circle_center.y = region.circle_center.y;
  message.circle_radius = static_cast<float>(region.circle_radius);
  message.area = static_cast<float>(region.area);
  return message;
}

}  // namespace robot_vision
