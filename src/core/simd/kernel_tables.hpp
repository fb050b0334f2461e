#pragma once

#include "instruction_sets.hpp"

namespace robot_vision
{

/// The kernels of one kind, `Kernels`, a struct of functions, for one instruction set. NAME_kernels.cpp defines `table`
/// and is compiled once for each set, with that set as ROBOT_VISION_SET.
///
/// No function of a header may be compiled there unless it is inlined for sure: the linker keeps one copy of each for
/// all of the library, which could be one with instructions that the machine does not have.
template <class Kernels, InstructionSet kSet>
struct KernelTable
{
  static const Kernels table;
};

/// Those of the current set. Rows that kernels write overlap no others, unless said.
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
