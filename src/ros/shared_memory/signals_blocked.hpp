#pragma once

#include <signal.h>

namespace robot_vision
{

/// Leaves the signals sent to the process to its other threads, for as long as this object exists; threads that are
/// started meanwhile leave them to others for good. Python's and roscpp's handlers expect them in threads of their own,
/// and roscpp takes a call of the master that a signal breaks off for a master that does not answer.
class SignalsBlocked
{
public:
  SignalsBlocked()
  {
    sigset_t sent;
    sigfillset(&sent);
    for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
      sigdelset(&sent, fault);
    pthread_sigmask(SIG_BLOCK, &sent, &before_);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsBlocked(const SignalsBlocked&) = delete;
  SignalsBlocked& operator=(const SignalsBlocked&) = delete;

private:
  sigset_t before_;
};

}  // namespace robot_vision
