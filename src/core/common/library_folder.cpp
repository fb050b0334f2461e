#include "library_folder.hpp"

#include <dlfcn.h>

#include <system_error>

namespace robot_vision
{

std::filesystem::path libraryFolder()
{
  static const char somewhere_in_the_library = 0;
  Dl_info info = {};
  if (dladdr(&somewhere_in_the_library, &info) == 0 || info.dli_fname == nullptr) return {};
  std::error_code error;
  const std::filesystem::path library = std::filesystem::canonical(info.dli_fname, error);
  return (error ? std::filesystem::path(info.dli_fname) : library).parent_path();
}

}  // namespace robot_vision
