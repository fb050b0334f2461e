#pragma once

#include <optional>
#include <vector>

namespace robot_vision
{

/// The instruction sets that kernels (loops over rows of pixels) are compiled for: all of them on x86-64, only the
/// baseline on other processors.
enum class InstructionSet
{
  kBaseline,
  kSse41,
  kAvx2,
  kAvx512,
  kAvx512Icl
};

/// The name of a set as in CMakeLists.txt: "baseline", "sse4.1", ...
const char* name(InstructionSet set);

/// The sets that this machine can run, the fastest first.
const std::vector<InstructionSet>& availableSets();

/// The set in use: the fastest one unless chooseSet() has chosen another.
InstructionSet currentSet();

/// Chooses the set to use, or the fastest one again if `set` is empty. Only for tests, and not while kernels run.
void chooseSet(std::optional<InstructionSet> set);

}  // namespace robot_vision
