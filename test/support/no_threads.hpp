#pragma once

#include <pthread.h>

#include <cstddef>

/// While it lives no thread can be started: its stack would be larger than the memory can be.
class NoThreads
{
public:
  NoThreads()
  {
    pthread_getattr_default_np(&usual_);
    pthread_attr_t attributes = usual_;
    pthread_attr_setstacksize(&attributes, std::size_t{1} << 60);
    pthread_setattr_default_np(&attributes);
  }
  ~NoThreads() { pthread_setattr_default_np(&usual_); }
  NoThreads(const NoThreads&) = delete;
  NoThreads& operator=(const NoThreads&) = delete;

private:
  pthread_attr_t usual_;
};
