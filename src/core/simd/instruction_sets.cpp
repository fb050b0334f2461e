#include "instruction_sets.hpp"

#include <atomic>

namespace robot_vision
{
namespace
{

std::vector<InstructionSet> findSets()
{
  std::vector<InstructionSet> found;
#ifdef ROBOT_VISION_X86_KERNELS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq"))
  {
    if (__builtin_cpu_supports("avx512vbmi") && __builtin_cpu_supports("avx512vnni"))
      found.push_back(InstructionSet::kAvx512Icl);
    found.push_back(InstructionSet::kAvx512);
  }
  if (__builtin_cpu_supports("avx2")) found.push_back(InstructionSet::kAvx2);
  if (__builtin_cpu_supports("sse4.1")) found.push_back(InstructionSet::kSse41);
#endif
  found.push_back(InstructionSet::kBaseline);
  return found;
}

std::atomic<InstructionSet>& current()
{
  static std::atomic<InstructionSet> set{availableSets().front()};
  return set;
}

}  // namespace

const char* name(InstructionSet set)
{
  static constexpr const char* kNames[] = {"baseline", "sse4.1", "avx2", "avx512", "avx512_icl"};
  return kNames[static_cast<int>(set)];
}

const std::vector<InstructionSet>& availableSets()
{
  static const std::vector<InstructionSet> available = findSets();
  return available;
}

InstructionSet currentSet()
{
  return current().load(std::memory_order_relaxed);
}

void chooseSet(std::optional<InstructionSet> set)
{
  current() = set.value_or(availableSets().front());
}

}  // namespace robot_vision
