#include "kernels.hpp"

#include <atomic>

namespace robot_vision
{

extern const Kernels kBaselineKernels;
#ifdef ROBOT_VISION_X86_KERNELS
extern const Kernels kSse41Kernels;
extern const Kernels kAvx2Kernels;
extern const Kernels kAvx512Kernels;
extern const Kernels kAvx512IclKernels;
#endif

namespace
{

std::atomic<const Kernels*> chosen_kernels{nullptr};

std::vector<const Kernels*> findKernels()
{
  std::vector<const Kernels*> found;
#ifdef ROBOT_VISION_X86_KERNELS
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq"))
  {
    if (__builtin_cpu_supports("avx512vbmi") && __builtin_cpu_supports("avx512vnni"))
      found.push_back(&kAvx512IclKernels);
    found.push_back(&kAvx512Kernels);
  }
  if (__builtin_cpu_supports("avx2")) found.push_back(&kAvx2Kernels);
  if (__builtin_cpu_supports("sse4.1")) found.push_back(&kSse41Kernels);
#endif
  found.push_back(&kBaselineKernels);
  return found;
}

}  // namespace

Division::Division(int divisor) : half(static_cast<std::uint16_t>(divisor / 2)), factor(0), shift(0)
{
  while (2 << shift <= divisor)
    ++shift;
  const std::uint32_t one = 1U << (16 + shift);
  factor = static_cast<std::uint16_t>((one + static_cast<std::uint32_t>(divisor) - 1) / divisor);
}

const std::vector<const Kernels*>& availableKernels()
{
  static const std::vector<const Kernels*> available = findKernels();
  return available;
}

const Kernels& kernels()
{
  const Kernels* const chosen = chosen_kernels.load(std::memory_order_relaxed);
  return chosen != nullptr ? *chosen : *availableKernels().front();
}

void chooseKernels(const Kernels* chosen)
{
  chosen_kernels = chosen;
}

}  // namespace robot_vision
