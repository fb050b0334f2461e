#include "work_limit.hpp"

#include <cstdint>
#include <stdexcept>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{

void requireWork(const std::string& params, double steps, const cv::Size& size, double most)
{
  if (steps * size.width * size.height <= most) return;
  throw std::invalid_argument(params + ", must be less, or the image of " + toText(size) + " have at most " +
                              std::to_string(static_cast<std::int64_t>(most / steps)) + " pixels");
}

}  // namespace robot_vision
