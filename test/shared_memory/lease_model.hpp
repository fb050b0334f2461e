#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <unordered_set>
#include <vector>

/// A model of processes that share memory: every order in which their operations can take effect is run through. Each
/// process may perform its operations in any order but for what the memory orders, the fences, the dependencies and the
/// addresses forbid, as processors do whose stores become visible to all others at once (x86, ARMv8).
namespace model
{

constexpr int kAddresses = 5;
using Memory = std::array<std::uint8_t, kAddresses>;

struct Operation;
/// One process' operations in the order of its program, at most 32.
using Program = std::vector<Operation>;

/// Whether all of these loads find the values that they are compared with.
struct Condition
{
  std::vector<int> guards;  // their places in the program
  bool expected = true;
};

struct Operation
{
  enum Kind
  {
    kNothing,
    kLoad,
    kStore,
    kOr,   // atomic
    kAnd,  // atomic
    kFence
  };
  Kind kind = kFence;
  int address = 0;
  std::memory_order order = std::memory_order_relaxed;
  std::uint8_t value = 0;  // what is stored; what a guard is compared with
  bool is_guard = false;   // a load on which it depends whether others happen
  std::vector<Condition> conditions;
};

struct State
{
  struct Process
  {
    std::uint32_t performed = 0;
    std::array<std::uint8_t, 32> loaded{};
  };
  Memory memory{};
  std::vector<Process> processes;

  bool hasPerformed(std::size_t process, std::size_t operation) const
  {
    return (processes[process].performed >> operation & 1) != 0;
  }
  std::string key() const
  {
    std::string text(memory.begin(), memory.end());
    for (const Process& process : processes)
    {
      text.append(reinterpret_cast<const char*>(&process.performed), sizeof(process.performed));
      text.append(process.loaded.begin(), process.loaded.end());
    }
    return text;
  }
};

enum class Truth
{
  kYes,
  kNo,
  kUnknown  // a guard has not been loaded
};

inline Truth allMatch(const Program& program, const State::Process& process, const std::vector<int>& guards)
{
  Truth result = Truth::kYes;
  for (const int guard : guards)
  {
    if ((process.performed >> guard & 1) == 0)
      result = Truth::kUnknown;
    else if (process.loaded[guard] != program[guard].value)
      return Truth::kNo;
  }
  return result;
}

inline Truth happens(const Program& program, const State::Process& process, const Operation& operation)
{
  Truth result = Truth::kYes;
  for (const Condition& condition : operation.conditions)
  {
    const Truth match = allMatch(program, process, condition.guards);
    if (match == Truth::kUnknown)
      result = Truth::kUnknown;
    else if ((match == Truth::kYes) != condition.expected)
      return Truth::kNo;
  }
  return result;
}

inline bool isAcquire(std::memory_order order)
{
  return order == std::memory_order_acquire || order == std::memory_order_seq_cst;
}

inline bool isRelease(std::memory_order order)
{
  return order == std::memory_order_release || order == std::memory_order_seq_cst;
}

/// Whether `earlier`, which comes first in the program, must take effect before `later`.
inline bool isOrdered(const Operation& earlier, const Operation& later)
{
  if (earlier.kind == Operation::kNothing || later.kind == Operation::kNothing) return false;
  if (earlier.kind == Operation::kFence || later.kind == Operation::kFence) return true;
  if (earlier.address == later.address) return true;
  if (earlier.kind != Operation::kStore && isAcquire(earlier.order)) return true;
  if (later.kind != Operation::kLoad && isRelease(later.order)) return true;
  return earlier.is_guard && later.kind != Operation::kLoad;  // nothing is stored on a guess
}

/// Runs through all orders, and calls `end` with each state that is left at an end, until it returns false. Returns the
/// number of states.
class Exploration
{
public:
  explicit Exploration(std::vector<Program> programs) : programs_(std::move(programs)) {}

  template <class End>
  std::size_t run(const Memory& memory, const End& end)
  {
    State state;
    state.memory = memory;
    state.processes.resize(programs_.size());
    for (std::size_t process = 0; process < programs_.size(); ++process)
      passOver(state, process);
    std::vector<State> left{state};
    std::unordered_set<std::string> seen{state.key()};
    while (!left.empty())
    {
      const State current = left.back();
      left.pop_back();
      bool is_end = true;
      for (std::size_t process = 0; process < programs_.size(); ++process)
        for (std::size_t operation = 0; operation < programs_[process].size(); ++operation)
        {
          if (!canPerform(current, process, operation)) continue;
          is_end = false;
          State next = current;
          perform(next, process, operation);
          if (seen.insert(next.key()).second) left.push_back(next);
        }
      if (is_end && !end(current)) break;
    }
    return seen.size();
  }

private:
  bool canPerform(const State& state, std::size_t process, std::size_t place) const
  {
    if (state.hasPerformed(process, place)) return false;
    const Program& program = programs_[process];
    const Operation& operation = program[place];
    const Truth known = happens(program, state.processes[process], operation);
    if (known == Truth::kUnknown && operation.kind != Operation::kLoad) return false;
    for (std::size_t earlier = 0; earlier < place; ++earlier)
      if (!state.hasPerformed(process, earlier) && isOrdered(program[earlier], operation)) return false;
    return true;
  }

  void perform(State& state, std::size_t process, std::size_t place) const
  {
    State::Process& here = state.processes[process];
    const Operation& operation = programs_[process][place];
    here.performed |= std::uint32_t{1} << place;
    std::uint8_t& cell = state.memory[operation.address];
    if (operation.kind == Operation::kLoad) here.loaded[place] = cell;
    if (operation.kind == Operation::kStore) cell = operation.value;
    if (operation.kind == Operation::kOr) cell |= operation.value;
    if (operation.kind == Operation::kAnd) cell &= operation.value;
    passOver(state, process);
  }

  /// Operations that are known not to happen are done with, and what was loaded by a wrong guess does not matter.
  void passOver(State& state, std::size_t process) const
  {
    State::Process& here = state.processes[process];
    const Program& program = programs_[process];
    for (std::size_t place = 0; place < program.size(); ++place)
    {
      if (program[place].kind != Operation::kNothing && happens(program, here, program[place]) != Truth::kNo) continue;
      here.performed |= std::uint32_t{1} << place;
      here.loaded[place] = 0;
    }
  }

  std::vector<Program> programs_;
};

}  // namespace model
