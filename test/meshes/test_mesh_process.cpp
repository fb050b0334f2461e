#include "core/meshes/mesh_process.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <system_error>

#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

constexpr double kTimeout = 60.0;  // s; all but one of the programs end at once

ProcessResult runShell(const std::string& script, std::size_t max_output = 1000, double timeout = kTimeout)
{
  return runProcess("/bin/sh", {"-c", script}, max_output, timeout);
}

}  // namespace

TEST(Process, givesWhatAProgramWritesAndHowItEnds)
{
  const ProcessResult result = runShell("printf one; printf two >&2; exit 3");
  EXPECT_EQ(result.output, "one");
  EXPECT_EQ(result.error, "two");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(result.signal, 0);
  EXPECT_FALSE(result.timed_out || result.too_long);
}

TEST(Process, tellsTheSignalThatHasEndedAProgram)
{
  const ProcessResult result = runShell("kill -SEGV $$");
  EXPECT_EQ(result.signal, SIGSEGV);
  EXPECT_EQ(result.exit_code, -1);
}

TEST(Process, isEndedWhenItTakesTooLong)
{
  const ProcessResult result = runShell("exec sleep 1000", 1000, 0.05);
  EXPECT_TRUE(result.timed_out);
  EXPECT_EQ(result.signal, SIGKILL);
}

TEST(Process, isEndedWhenItWritesTooMuch)
{
  const ProcessResult result = runShell("while :; do echo 0123456789; done");
  EXPECT_TRUE(result.too_long);
  EXPECT_EQ(result.output.size(), 1000U);
  EXPECT_EQ(result.signal, SIGKILL);
}

TEST(Process, mayWriteAsManyErrorsAsItLikes)
{
  const ProcessResult result =
      runShell("i=0; while [ $i -lt 2000 ]; do echo 0123456789 >&2; i=$((i + 1)); done; echo ok");
  EXPECT_EQ(result.output, "ok\n");
  EXPECT_EQ(result.error.size(), 4000U);
  EXPECT_EQ(result.exit_code, 0);
}

TEST(Process, readsNothingFromTheTerminal)
{
  EXPECT_EQ(runShell("cat; echo end").output, "end\n");
}

TEST(Process, isRefusedIfThereIsNone)
{
  EXPECT_EQ(refusal<std::system_error>([] { runProcess("/nowhere/program", {}, 10, kTimeout); }),
            "/nowhere/program cannot be started: No such file or directory");
}
