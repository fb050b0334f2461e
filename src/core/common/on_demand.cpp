#include "robot_vision/common/on_demand.hpp"

#include <dlfcn.h>

#include <stdexcept>
#include <string>

#include "library_folder.hpp"

namespace robot_vision
{

void* onDemand(const char* library, const char* name)
{
  const std::string path = libraryFolder() / (std::string("librobot_vision_") + library + ".so");
  void* const handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);  // the same one each time
  if (handle == nullptr) throw std::runtime_error(path + " cannot be loaded: " + dlerror());
  void* const function = dlsym(handle, name);
  if (function == nullptr) throw std::runtime_error(path + " has no function " + name);
  return function;
}

}  // namespace robot_vision
