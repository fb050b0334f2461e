#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "lease_model.hpp"
#include "ros/shared_memory/lease_protocol.hpp"

namespace lease = robot_vision::lease;
using model::Condition;
using model::Operation;
using model::Program;

namespace
{

enum Address
{
  kRow0,
  kRow1,
  kGeneration,
  kPixel0,
  kPixel1
};
constexpr std::uint8_t kBit = 1;
constexpr std::uint8_t kFirst = 2;  // the generation that is there at first, of which all pixels have the value
constexpr std::uint8_t kSecond = 4;
constexpr std::uint8_t kThird = 6;

/// Tells what the code of the leases does with a word.
class RecordedWord
{
public:
  RecordedWord(Program& program, int address, std::uint64_t content = 0)
    : program_(program), address_(address), content_(content)
  {
  }
  std::uint64_t load(std::memory_order order) const
  {
    add(Operation::kLoad, order, 0);
    return content_;
  }
  void store(std::uint64_t value, std::memory_order order) { add(Operation::kStore, order, value); }
  void fetch_or(std::uint64_t value, std::memory_order order) { add(Operation::kOr, order, value); }
  void fetch_and(std::uint64_t value, std::memory_order order) { add(Operation::kAnd, order, value); }

private:
  void add(Operation::Kind kind, std::memory_order order, std::uint64_t value) const
  {
    program_.push_back({kind, address_, order, static_cast<std::uint8_t>(value), false, {}});
  }

  Program& program_;
  int address_;
  std::uint64_t content_;
};

void access(Program& program, Operation::Kind kind, int address, std::uint8_t value = 0)
{
  program.push_back({kind, address, std::memory_order_relaxed, value, false, {}});
}

void addFence(Program& program)
{
  access(program, Operation::kFence, 0);
}

/// What lease::hold() does where the generation is this one.
Program recordedHold(int row, std::uint8_t expected, std::uint8_t found)
{
  Program program;
  RecordedWord word(program, row);
  const RecordedWord generation(program, kGeneration, found);
  EXPECT_EQ(lease::hold(word, kBit, generation, expected, [&] { addFence(program); }), found == expected);
  return program;
}

/// What lease::take() does where the rows are as these two looks find them.
Program recordedTake(std::uint8_t published, bool first_held, bool second_held)
{
  Program program;
  RecordedWord generation(program, kGeneration);
  bool held = second_held;
  bool next = first_held;
  const auto look = [&]
  {
    std::swap(held, next);
    for (const int row : {kRow0, kRow1})
      RecordedWord(program, row).load(std::memory_order_acquire);
    return held;
  };
  EXPECT_EQ(lease::take(generation, published, look, [&] { addFence(program); }), !first_held && !second_held);
  return program;
}

/// Appends operations that happen on these conditions; returns the place of the first.
int append(Program& program, const Program& more, const std::vector<Condition>& conditions)
{
  const int place = static_cast<int>(program.size());
  for (Operation operation : more)
  {
    operation.conditions = conditions;
    program.push_back(operation);
  }
  return place;
}

std::vector<int> asGuards(Program& program, int place, int count, std::uint8_t value)
{
  std::vector<int> guards;
  for (int guard = place; guard < place + count; ++guard)
  {
    program[guard].is_guard = true;
    program[guard].value = value;
    guards.push_back(guard);
  }
  return guards;
}

Program part(const Program& program, std::size_t begin, std::size_t end)
{
  return {program.begin() + static_cast<std::ptrdiff_t>(begin), program.begin() + static_cast<std::ptrdiff_t>(end)};
}

constexpr int kHold = 3;  // operations until the generation is known
constexpr int kReaderLength = 7;
constexpr int kWriterLength = 10;

/// A reader that holds a frame, reads its pixels and gives it back.
void appendReading(Program& program, int row, std::uint8_t expected)
{
  const Program matched = recordedHold(row, expected, expected);
  const Program mismatched = recordedHold(row, expected, expected + 1);
  ASSERT_EQ(matched.size(), kHold);
  ASSERT_EQ(mismatched.size(), kHold + 1);
  const int begin = append(program, matched, {});
  const std::vector<int> guards = asGuards(program, begin + kHold - 1, 1, expected);
  Program rest;
  access(rest, Operation::kLoad, kPixel0);
  access(rest, Operation::kLoad, kPixel1);
  RecordedWord word(rest, row);
  lease::release(word, kBit);
  append(program, rest, {{guards, true}});
  append(program, part(mismatched, kHold, kHold + 1), {{guards, false}});
}

/// How the writer fared.
struct Try
{
  std::vector<Condition> published;
  std::vector<Condition> restored;  // held at the second look
};

std::vector<Condition> also(std::vector<Condition> conditions, const Condition& more)
{
  conditions.push_back(more);
  return conditions;
}

/// A writer that takes the slot, if it can, and publishes a frame in it.
Try appendWriting(Program& program, std::uint8_t published, std::uint8_t next, const std::vector<Condition>& conditions)
{
  EXPECT_EQ(recordedTake(published, true, false).size(), 2U);
  const Program taken = recordedTake(published, false, false);
  const Program refused = recordedTake(published, false, true);
  EXPECT_EQ(taken.size(), 6U);
  EXPECT_EQ(refused.size(), 7U);
  const Condition first{asGuards(program, append(program, part(taken, 0, 2), conditions), 2, 0), true};
  const std::vector<Condition> marked = also(conditions, first);
  const int marking = append(program, part(taken, 2, 6), marked);
  const std::vector<int> second = asGuards(program, marking + 2, 2, 0);
  Program writing;
  access(writing, Operation::kStore, kPixel0, next);
  access(writing, Operation::kStore, kPixel1, next);
  RecordedWord generation(writing, kGeneration);
  lease::publish(generation, next);
  append(program, writing, also(marked, {second, true}));
  append(program, part(refused, 6, 7), also(marked, {second, false}));
  return {also(marked, {second, true}), also(marked, {second, false})};
}

/// Two readers that try to read the first and the second frame, and a writer that replaces the first by the second and
/// then by a third, or tries again after it found the slot held.
std::vector<Program> programs(bool tries_again)
{
  std::vector<Program> all(3);
  const Try fared = appendWriting(all[0], kFirst, kSecond, {});
  if (tries_again)
    appendWriting(all[0], kFirst, kSecond, fared.restored);
  else
    appendWriting(all[0], kSecond, kThird, fared.published);
  EXPECT_EQ(all[0].size(), 2U * kWriterLength);
  for (int reader = 0; reader < 2; ++reader)
    for (const std::uint8_t expected : {kFirst, kSecond})
      appendReading(all[1 + reader], kRow0 + reader, expected);
  return all;
}

struct Outcome
{
  std::size_t states = 0;
  std::set<std::string> faults;
  std::set<std::string> seen;  // what has happened in one order or another
};

/// All that can happen; or, with a fault that is looked for, what has happened when it is found.
Outcome explore(const std::vector<Program>& all, const std::string& wanted = "")
{
  Outcome outcome;
  model::Exploration exploration(all);
  const auto end = [&](const model::State& state)
  {
    if ((state.memory[kGeneration] & lease::kBusy) != 0) outcome.faults.insert("the slot stays busy");
    if (state.memory[kRow0] != 0 || state.memory[kRow1] != 0) outcome.faults.insert("the slot stays held");
    outcome.seen.insert("left " + std::to_string(state.memory[kGeneration]));
    for (std::size_t reader = 1; reader < all.size(); ++reader)
      for (std::size_t place = 0; place < all[reader].size(); place += kReaderLength)
      {
        const auto& loaded = state.processes[reader].loaded;
        const Operation& check = all[reader][place + kHold - 1];
        if (check.kind == Operation::kLoad && loaded[place + kHold - 1] != check.value) continue;
        outcome.seen.insert("held " + std::to_string(check.value));
        if (loaded[place + kHold] != check.value || loaded[place + kHold + 1] != check.value)
          outcome.faults.insert("a frame is torn");
      }
    return outcome.faults.count(wanted) == 0;
  };
  outcome.states = exploration.run({0, 0, kFirst, kFirst, kFirst}, end);
  return outcome;
}

struct Mutant
{
  std::string name;
  std::string fault;  // that must be found
  std::function<void(std::vector<Program>&)> change;
};

/// Changes these operations of both readers' tries.
std::function<void(std::vector<Program>&)> inReaders(int place, const std::function<void(Operation&)>& change)
{
  return [=](std::vector<Program>& all)
  {
    for (std::size_t reader = 1; reader < all.size(); ++reader)
      for (std::size_t begin = 0; begin < all[reader].size(); begin += kReaderLength)
        change(all[reader][begin + place]);
  };
}

std::function<void(std::vector<Program>&)> inWriter(std::vector<int> places,
                                                    const std::function<void(Operation&)>& change)
{
  return [=](std::vector<Program>& all)
  {
    for (const int place : places)
      for (const int begin : {0, kWriterLength})
        change(all[0][begin + place]);
  };
}

void leaveOut(Operation& operation)
{
  operation.kind = Operation::kNothing;
}

void relax(Operation& operation)
{
  operation.order = std::memory_order_relaxed;
}

const std::vector<Mutant> kMutants = {
    {"the reader has no fence", "a frame is torn", inReaders(1, leaveOut)},
    {"the reader does not set its bit", "a frame is torn", inReaders(0, leaveOut)},
    {"the reader does not look at the generation", "a frame is torn",
     [](auto& all)
     {
       inReaders(kHold - 1, leaveOut)(all);
       for (int place = kHold; place < kReaderLength; ++place)
         inReaders(place, [](Operation& operation) { operation.conditions.clear(); })(all);
     }},
    {"the reader reads before it looks", "a frame is torn", inReaders(kHold - 1, relax)},
    {"the reader gives back before it has read", "a frame is torn", inReaders(kHold + 2, relax)},
    {"the reader does not give back", "the slot stays held", inReaders(kHold + 2, leaveOut)},
    {"the reader keeps its bit for another frame", "the slot stays held", inReaders(kHold + 3, leaveOut)},
    {"the writer has no fence", "a frame is torn", inWriter({3}, leaveOut)},
    {"the writer does not mark", "a frame is torn", inWriter({2}, leaveOut)},
    {"the writer does not look again", "a frame is torn",
     [](auto& all)
     {
       inWriter({4, 5, 9}, leaveOut)(all);
       const auto is_look = [](const Condition& condition) { return condition.guards.front() % kWriterLength == 4; };
       for (Operation& operation : all[0])
       {
         auto& conditions = operation.conditions;
         conditions.erase(std::remove_if(conditions.begin(), conditions.end(), is_look), conditions.end());
       }
     }},
    {"the writer overlooks a row", "a frame is torn", inWriter({1, 5}, [](Operation& look) { look.address = kRow0; })},
    {"the writer publishes before it has written", "a frame is torn", inWriter({8}, relax)},
    {"the writer does not restore", "the slot stays busy", inWriter({9}, leaveOut)},
};

}  // namespace

TEST(LeaseModel, noFrameIsTornAndNoSlotIsLostInAnyOrder)
{
  for (const bool tries_again : {false, true})
  {
    const Outcome outcome = explore(programs(tries_again));
    EXPECT_EQ(outcome.faults, std::set<std::string>{});
    std::set<std::string> possible{"held 2", "held 4", "left 2", "left 4"};
    if (!tries_again) possible.insert("left 6");
    EXPECT_EQ(outcome.seen, possible);
    EXPECT_GT(outcome.states, 5000U);
    RecordProperty(tries_again ? "states_when_trying_again" : "states", static_cast<int>(outcome.states));
  }
}

TEST(LeaseModel, findsWhatIsLeftOut)
{
  for (const Mutant& mutant : kMutants)
  {
    SCOPED_TRACE(mutant.name);
    std::vector<Program> all = programs(false);
    mutant.change(all);
    EXPECT_EQ(explore(all, mutant.fault).faults.count(mutant.fault), 1U);
  }
}
