#include "control_enumerator.hpp"

#include <algorithm>
#include <cerrno>

namespace robot_vision
{
namespace
{

constexpr std::uint32_t kNext = V4L2_CTRL_FLAG_NEXT_CTRL | V4L2_CTRL_FLAG_NEXT_COMPOUND;
constexpr int kMaxFailures = 16;  // then the device as a whole is out of order

// Each class has 0x10000 ids, of which those of controls begin at 0x900.
constexpr std::uint32_t kClass = 0x10000;
constexpr std::uint32_t kFirst = 0x900;
constexpr std::uint32_t kClassBegin = V4L2_CTRL_CLASS_USER;
constexpr std::uint32_t kClassEnd = V4L2_CTRL_CLASS_USER + 0x10 * kClass;
constexpr std::uint32_t kWidestGap = 0x40;  // between the ids of two controls of a class

/// The ids that a control may have, one after the other; 0: there are no more.
std::uint32_t idAfter(std::uint32_t id, std::uint32_t begin)
{
  const std::uint32_t id_class = std::max(id / kClass * kClass, kClassBegin);
  if (id < id_class + kFirst) return id_class + kFirst;
  const std::uint32_t gap_end = std::max(begin, id_class + kFirst) + kWidestGap;
  if (id < gap_end) return id + 1;
  return id_class + kClass < kClassEnd ? id_class + kClass + kFirst : 0;
}

}  // namespace

bool ControlEnumerator::next(v4l2_query_ext_ctrl& query)
{
  int error;
  while ((error = ask(id_ | kNext, query)) != 0)
  {
    if (error == EINVAL || error == ENOTTY || ++failures_ > kMaxFailures) return false;
    error = stepOver(query);
    if (error == 0) break;
    if (error == EINVAL) return false;
  }
  id_ = query.id;
  return true;
}

int ControlEnumerator::ask(std::uint32_t id, v4l2_query_ext_ctrl& query)
{
  query = {};
  query.id = id;
  const int error = device_.tryCall(VIDIOC_QUERY_EXT_CTRL, &query);
  if (error == ENODEV) device_.fail("VIDIOC_QUERY_EXT_CTRL", error);
  return error;
}

/// Finds the control that could not be described: the driver does not say which it is. The error that it answers with,
/// 0 if it can be described after all, EINVAL if there is none.
int ControlEnumerator::stepOver(v4l2_query_ext_ctrl& query)
{
  const std::uint32_t begin = id_;
  for (std::uint32_t id = idAfter(begin, begin); id != 0; id = idAfter(id, begin))
  {
    id_ = id;
    const int error = ask(id, query);
    if (error != EINVAL) return error;
  }
  return EINVAL;
}

}  // namespace robot_vision
