#pragma once

#include <cstddef>
#include <vector>

namespace robot_vision
{

/// The root of the set that one is in, of sets that are joined by giving the root of one a parent in another one. A
/// root is its own parent. Ways that were gone become half as long for the next one.
inline int rootOf(std::vector<int>& parents, int one)
{
  while (parents[static_cast<std::size_t>(one)] != one)
  {
    int& parent = parents[static_cast<std::size_t>(one)];
    parent = parents[static_cast<std::size_t>(parent)];
    one = parent;
  }
  return one;
}

}  // namespace robot_vision
