#pragma once

#include "instruction_sets.hpp"

namespace robot_vision
{

/// The kernels of one room for one instruction set; `Kernels` is a struct of function pointers. NAME_kernels.cpp
/// defines `table` and is compiled once for each set, with that set as ROBOT_VISION_SET.
///
/// A NAME_kernels.cpp must not call functions of headers unless they are certainly inlined: the linker keeps a single
/// copy of such a function for the whole library, and that copy may use instructions that the machine does not have.
template <class Kernels, InstructionSet kSet>
struct KernelTable
{
  static const Kernels table;
};

/// The kernels of the current set. Rows that a kernel writes must not overlap its other rows unless it says so.
template <class Kernels>
const Kernels& kernels()
{
#ifdef ROBOT_VISION_X86_KERNELS
  switch (currentSet())
  {
    case InstructionSet::kAvx512Icl:
      return KernelTable<Kernels, InstructionSet::kAvx512Icl>::table;
    case InstructionSet::kAvx512:
      return KernelTable<Kernels, InstructionSet::kAvx512>::table;
    case InstructionSet::kAvx2:
      return KernelTable<Kernels, InstructionSet::kAvx2>::table;
    case InstructionSet::kSse41:
      return KernelTable<Kernels, InstructionSet::kSse41>::table;
    case InstructionSet::kBaseline:
      break;
  }
#endif
  return KernelTable<Kernels, InstructionSet::kBaseline>::table;
}

}  // namespace robot_vision
