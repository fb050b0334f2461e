#include "transports.hpp"

#include <vector>

#include "robot_vision/common/range.hpp"

namespace robot_vision
{

void requireTransport(const image_transport::ImageTransport& it, const std::string& transport)
{
  std::vector<std::string> known;
  for (std::string name : it.getLoadableTransports())
  {
    name.erase(0, name.find('/') + 1);  // the names are like image_transport/raw
    if (name == transport) return;
    known.push_back(name);
  }
  require(false, "image_transport", "'" + transport + "'", "one that is installed: " + joined(known));
}

}  // namespace robot_vision
