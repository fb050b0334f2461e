#include "mesh_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <system_error>

#include "core/common/library_folder.hpp"

namespace robot_vision
{
namespace
{

constexpr std::size_t kMaxError = 4000;               // bytes
constexpr std::size_t kChunk = std::size_t{1} << 16;  // bytes

/// The two ends of a pipe, which no other program inherits.
class Pipe
{
public:
  Pipe()
  {
    if (pipe2(ends_, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "no pipe can be made");
  }
  ~Pipe()
  {
    closeEnd(0);
    closeEnd(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int reader() const { return ends_[0]; }
  int writer() const { return ends_[1]; }
  void closeWriter() { closeEnd(1); }

private:
  void closeEnd(int end)
  {
    if (ends_[end] >= 0) close(ends_[end]);
    ends_[end] = -1;
  }

  int ends_[2] = {-1, -1};
};

pid_t start(const std::string& program, const std::vector<std::string>& arguments, const Pipe& output,
            const Pipe& error)
{
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments)
    argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  // Libraries for matrices, which others bring along, begin with a thread and a lot of memory for each core.
  static const char* const environment[] = {"PATH=/usr/bin:/bin", "LANG=C.UTF-8", "OPENBLAS_NUM_THREADS=1",
                                            "OMP_NUM_THREADS=1", nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output.writer(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, error.writer(), STDERR_FILENO);
  pid_t process = -1;
  const int failure =
      posix_spawn(&process, program.c_str(), &actions, nullptr, argv.data(), const_cast<char* const*>(environment));
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) throw std::system_error(failure, std::generic_category(), program + " cannot be started");
  return process;
}

/// Appends what there is to read; returns false at the end.
bool readSome(int file, std::string& text, std::size_t most, bool& too_long)
{
  char chunk[kChunk];
  const ssize_t count = read(file, chunk, sizeof(chunk));
  if (count < 0) return errno == EINTR || errno == EAGAIN;
  if (count == 0) return false;
  const std::size_t room = most - std::min(most, text.size());
  text.append(chunk, std::min(static_cast<std::size_t>(count), room));
  too_long = too_long || static_cast<std::size_t>(count) > room;
  return true;
}

/// Reads until both have ended, or it takes too long, or the first one is too long.
void readAll(const Pipe& output, const Pipe& error, std::size_t max_output, double timeout, ProcessResult& result)
{
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout);
  pollfd files[2] = {{output.reader(), POLLIN, 0}, {error.reader(), POLLIN, 0}};
  bool error_is_long = false;
  while ((files[0].fd >= 0 || files[1].fd >= 0) && !result.too_long)
  {
    const double left = std::chrono::duration<double>(end - std::chrono::steady_clock::now()).count();
    result.timed_out = left <= 0.0;
    if (result.timed_out) return;
    poll(files, 2, static_cast<int>(left * 1000.0) + 1);
    if (files[0].revents != 0 && !readSome(files[0].fd, result.output, max_output, result.too_long)) files[0].fd = -1;
    if (files[1].revents != 0 && !readSome(files[1].fd, result.error, kMaxError, error_is_long)) files[1].fd = -1;
    files[0].revents = files[1].revents = 0;
  }
}

void collect(pid_t process, ProcessResult& result)
{
  int status = 0;
  while (waitpid(process, &status, 0) < 0)
    if (errno != EINTR) return;  // somebody else takes the ends of all processes: what it wrote must do
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
}

}  // namespace

ProcessResult runProcess(const std::string& program, const std::vector<std::string>& arguments, std::size_t max_output,
                         double timeout)
{
  Pipe output, error;
  const pid_t process = start(program, arguments, output, error);
  output.closeWriter();
  error.closeWriter();
  ProcessResult result;
  try
  {
    readAll(output, error, max_output, timeout, result);
  }
  catch (...)  // no memory
  {
    kill(process, SIGKILL);
    collect(process, result);
    throw;
  }
  if (result.timed_out || result.too_long) kill(process, SIGKILL);
  collect(process, result);
  return result;
}

std::string programPath(const std::string& name)
{
  const std::filesystem::path folder = libraryFolder();
  return folder.empty() ? name : (folder / "robot_vision" / name).string();
}

}  // namespace robot_vision
