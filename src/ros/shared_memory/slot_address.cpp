#include "slot_address.hpp"

#include <fstream>

namespace robot_vision
{

const std::string& bootId()
{
  static const std::string id = []
  {
    std::string line;
    std::getline(std::ifstream("/proc/sys/kernel/random/boot_id"), line);
    return line;
  }();
  return id;
}

}  // namespace robot_vision
