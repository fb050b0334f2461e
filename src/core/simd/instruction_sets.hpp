#pragma once

#include <optional>
#include <vector>

namespace robot_vision
{

/// What kernels, the loops over rows of pixels, are compiled for. Elsewhere than on x86-64 the first one only.
enum class InstructionSet
{
  kBaseline,
  kSse41,
  kAvx2,
  kAvx512,
  kAvx512Icl
};

/// As in CMakeLists.txt: "baseline", "sse4.1", ...
const char* name(InstructionSet set);

/// Those that this machine can run, the best first.
const std::vector<InstructionSet>& availableSets();

/// The best of them, or the one chosen.
InstructionSet currentSet();

/// For tests; none: the best. Not while others work.
void chooseSet(std::optional<InstructionSet> set);

}  // namespace robot_vision
