#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <thread>

namespace robot_vision
{

/// Leaves the GIL to others for the time of a call; not once the process ends. CPython would kill a thread that takes
/// the GIL back after the interpreter has gone, by unwinding its stack, which for C++ like this ends in
/// std::terminate(): such a thread stays where it is.
class LeaveGil
{
public:
  LeaveGil()
  {
    if (process_ends_) return;
    ++under_way_;
    thread_ = PyEval_SaveThread();
  }

  ~LeaveGil()
  {
    if (thread_ == nullptr) return;
    ++returning_;
    if (closed_) stay();
    PyEval_RestoreThread(thread_);
    --returning_;
    --under_way_;
  }

  LeaveGil(const LeaveGil&) = delete;
  LeaveGil& operator=(const LeaveGil&) = delete;

  /// Has the module's calls end before the interpreter does; to be called when the module is imported.
  static void endWithProcess() { pybind11::module::import("atexit").attr("register")(pybind11::cpp_function(&end)); }

private:
  /// Waits a moment for the calls under way; from now on none begins without the GIL, and none takes it back.
  static void end()
  {
    constexpr std::chrono::milliseconds kGrace(500);
    process_ends_ = true;  // under the GIL: no other thread is about to begin a call
    const pybind11::gil_scoped_release unlocked;
    const auto deadline = std::chrono::steady_clock::now() + kGrace;
    while (under_way_ > 0 && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    closed_ = true;
    while (returning_ > 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    // A call that still works must not lose what it uses to the destructors of the process.
    if (under_way_ > 0) on_exit([](int status, void*) { std::_Exit(status); }, nullptr);
  }

  [[noreturn]] static void stay()
  {
    --returning_;
    while (true)
      std::this_thread::sleep_for(std::chrono::hours(1));
  }

  // Of a module, whose symbols are its own.
  static inline std::atomic<bool> process_ends_{false};
  static inline std::atomic<bool> closed_{false};
  static inline std::atomic<int> under_way_{0};
  static inline std::atomic<int> returning_{0};

  PyThreadState* thread_ = nullptr;  // while it is without the GIL
};

using Unlocked = pybind11::call_guard<LeaveGil>;

/// What `work` returns, which does not have the GIL.
template <class Work>
auto withoutGil(const Work& work)
{
  const LeaveGil unlocked;
  return work();
}

}  // namespace robot_vision
