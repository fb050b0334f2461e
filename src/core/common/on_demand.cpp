#include "robot_vision/common/on_demand.hpp"

#include <dlfcn.h>

#include <stdexcept>
#include <string>

namespace robot_vision
{
namespace
{

/// The folder of the core's own library, with a slash; others of the package are there, too.
std::string ownFolder()
{
  Dl_info own{};
  if (dladdr(reinterpret_cast<const void*>(&ownFolder), &own) == 0 || own.dli_fname == nullptr) return {};
  const std::string path = own.dli_fname;
  return path.substr(0, path.rfind('/') + 1);
}

}  // namespace

void* onDemand(const char* library, const char* name)
{
  const std::string path = ownFolder() + "librobot_vision_" + library + ".so";
  void* const handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);  // the same one each time
  if (handle == nullptr) throw std::runtime_error(path + " cannot be loaded: " + dlerror());
  void* const function = dlsym(handle, name);
  if (function == nullptr) throw std::runtime_error(path + " has no function " + name);
  return function;
}

}  // namespace robot_vision
