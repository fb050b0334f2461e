#include "control_enumerator.hpp"

#include <algorithm>
#include <cerrno>

namespace robot_vision
{
namespace
{

constexpr std::uint32_t kNextControlFlags = V4L2_CTRL_FLAG_NEXT_CTRL | V4L2_CTRL_FLAG_NEXT_COMPOUND;
constexpr int kMaxFailures = 16;  // after more of them, the device as a whole is taken to be out of order

// Each class of controls has 0x10000 ids; the ids of its controls begin at 0x900.
constexpr std::uint32_t kClassSize = 0x10000;
constexpr std::uint32_t kFirstControl = 0x900;
constexpr std::uint32_t kClassBegin = V4L2_CTRL_CLASS_USER;
constexpr std::uint32_t kClassEnd = V4L2_CTRL_CLASS_USER + 0x10 * kClassSize;
constexpr std::uint32_t kMaxGap = 0x40;  // between the ids of two controls of a class

/// The next id that a control may have after `id`, in a search that started at `begin`; 0 if there is none.
std::uint32_t idAfter(std::uint32_t id, std::uint32_t begin)
{
  const std::uint32_t id_class = std::max(id / kClassSize * kClassSize, kClassBegin);
  if (id < id_class + kFirstControl) return id_class + kFirstControl;
  const std::uint32_t gap_end = std::max(begin, id_class + kFirstControl) + kMaxGap;
  if (id < gap_end) return id + 1;
  return id_class + kClassSize < kClassEnd ? id_class + kClassSize + kFirstControl : 0;
}

}  // namespace

bool ControlEnumerator::next(v4l2_query_ext_ctrl& query)
{
  int error;
  while ((error = ask(id_ | kNextControlFlags, query)) != 0)
  {
    if (error == EINVAL || error == ENOTTY || ++failures_ > kMaxFailures) return false;
    error = findUndescribed(query);
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

/// Finds the id of the control that the driver failed to describe, which the driver does not tell. Returns the errno of
/// the driver's answer for it: 0 if the driver describes it after all, EINVAL if no such control is found.
int ControlEnumerator::findUndescribed(v4l2_query_ext_ctrl& query)
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
