// Runs all tests with the kernels of one instruction set, which --kernels=NAME chooses. The default is the fastest set.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <optional>
#include <string>

#include "core/simd/instruction_sets.hpp"

namespace
{

constexpr const char* kOption = "--kernels=";
const std::string kSets[] = {KERNEL_SETS};

/// The set with this name, or nothing if the machine cannot run it.
std::optional<robot_vision::InstructionSet> find(const char* name)
{
  for (const robot_vision::InstructionSet set : robot_vision::availableSets())
    if (std::strcmp(robot_vision::name(set), name) == 0) return set;
  return std::nullopt;
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
    const auto set = find(name);
    if (!set)
    {
      std::printf("this machine has no %s\n", name);
      testing::GTEST_FLAG(filter) = "-*";  // runs no test, but writes the report
    }
    robot_vision::chooseSet(set);
  }
  return RUN_ALL_TESTS();
}
