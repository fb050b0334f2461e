// Runs all tests with the kernels of one instruction set: --kernels=NAME; without it with the best.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <string>

#include "core/simd/kernels.hpp"

namespace
{

constexpr const char* kOption = "--kernels=";
const std::string kSets[] = {KERNEL_SETS};

/// Null: the machine has no such set.
const robot_vision::Kernels* find(const char* name)
{
  for (const robot_vision::Kernels* set : robot_vision::availableKernels())
    if (std::strcmp(set->name, name) == 0) return set;
  return nullptr;
}

}  // namespace

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  for (int i = 1; i < argc; ++i)
  {
    if (std::strncmp(argv[i], kOption, std::strlen(kOption)) != 0) continue;
    const char* const name = argv[i] + std::strlen(kOption);
    if (std::find(std::begin(kSets), std::end(kSets), std::string(name)) == std::end(kSets))
    {
      std::printf("%s is none of the sets that are built\n", name);
      return 2;
    }
    const robot_vision::Kernels* const set = find(name);
    if (set == nullptr)
    {
      std::printf("this machine has no %s\n", name);
      testing::GTEST_FLAG(filter) = "-*";  // the report of no test is wanted nevertheless
    }
    robot_vision::chooseKernels(set);
  }
  return RUN_ALL_TESTS();
}
