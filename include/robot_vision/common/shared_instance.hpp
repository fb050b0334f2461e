#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <tuple>

namespace robot_vision
{

/// The object that is made from these arguments. All callers get the same one as long as somebody holds it.
/// Thread-safe.
template <class T, class... Args>
std::shared_ptr<T> sharedInstance(const Args&... args)
{
  static std::mutex mutex;
  static std::map<std::tuple<Args...>, std::weak_ptr<T>> in_use;
  const std::lock_guard lock(mutex);
  std::weak_ptr<T>& known = in_use[std::tuple<Args...>(args...)];
  std::shared_ptr<T> instance = known.lock();
  if (!instance) known = instance = std::make_shared<T>(args...);
  return instance;
}

}  // namespace robot_vision
