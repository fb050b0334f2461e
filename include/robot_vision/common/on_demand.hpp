#pragma once

namespace robot_vision
{

/// The function `name` (with C linkage) of librobot_vision_`library`.so, which is loaded when the first of its
/// functions is asked for, and stays. It is for what few processes need and what brings many libraries along, as
/// OpenCV's readers of files and videos do: to load them takes longer than to load all others. Throws
/// std::runtime_error if it cannot be loaded.
void* onDemand(const char* library, const char* name);

/// The same, as a function of this type.
template <class Function>
Function* onDemand(const char* library, const char* name)
{
  return reinterpret_cast<Function*>(onDemand(library, name));
}

}  // namespace robot_vision
