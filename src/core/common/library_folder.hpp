#pragma once

#include <filesystem>

namespace robot_vision
{

/// The folder of the core's own library, where others of the package are, too; empty if it cannot be found out.
std::filesystem::path libraryFolder();

}  // namespace robot_vision
