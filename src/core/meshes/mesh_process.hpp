#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace robot_vision
{

/// How a program ended, and what it wrote.
struct ProcessResult
{
  int exit_code = -1;  // -1: a signal has ended it
  int signal = 0;
  bool timed_out = false;  // it was ended for that, or because it wrote more than it may
  bool too_long = false;
  std::string output, error;
};

/// Runs a program with arguments, without a shell, and waits for its end. It may write `max_output` bytes and 4000
/// bytes of errors, and take `timeout` s. Throws std::system_error if it cannot be started.
ProcessResult runProcess(const std::string& program, const std::vector<std::string>& arguments, std::size_t max_output,
                         double timeout);

/// The path of a program of this package: beside the library of the core, or below it, as it was built or installed.
std::string programPath(const std::string& name);

}  // namespace robot_vision
