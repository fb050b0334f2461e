#include "core/simd/kernel_tables.hpp"

#include <gtest/gtest.h>

#include "core/image/bit_kernels.hpp"

using namespace robot_vision;

// The tests call kernels() themselves, and so compile it themselves.
TEST(KernelTables, areThoseOfTheCurrentSet)
{
  const BitKernels* const baseline = &KernelTable<BitKernels, InstructionSet::kBaseline>::table;
  EXPECT_EQ(&kernels<BitKernels>() == baseline, currentSet() == InstructionSet::kBaseline) << name(currentSet());
}
