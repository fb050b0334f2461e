#include "control_enumerator.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>

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

int ask(V4l2Device& device, std::uint32_t id, v4l2_query_ext_ctrl& query)
{
  query = {};
  query.id = id;
  const int error = device.tryCall(VIDIOC_QUERY_EXT_CTRL, &query);
  if (error == ENODEV) device.fail("VIDIOC_QUERY_EXT_CTRL", error);
  return error;
}

/// Finds the id of the control after `id` that the driver failed to describe, which the driver does not tell. Returns
/// the errno of the driver's answer for it: 0 if the driver describes it after all, EINVAL if no such control is found.
int findUndescribed(V4l2Device& device, std::uint32_t& id, v4l2_query_ext_ctrl& query)
{
  const std::uint32_t begin = id;
  for (std::uint32_t next = idAfter(begin, begin); next != 0; next = idAfter(next, begin))
  {
    id = next;
    const int error = ask(device, id, query);
    if (error != EINVAL) return error;
  }
  return EINVAL;
}

}  // namespace

std::vector<v4l2_query_ext_ctrl> enumerateControls(V4l2Device& device)
{
  std::vector<v4l2_query_ext_ctrl> controls;
  v4l2_query_ext_ctrl query;
  int failures = 0;
  for (std::uint32_t id = 0;;)
  {
    const std::uint32_t before = id;
    int error = ask(device, id | kNextControlFlags, query);
    if (error == EINVAL || error == ENOTTY || (error != 0 && ++failures > kMaxFailures)) return controls;
    if (error != 0) error = findUndescribed(device, id, query);
    if (error == EINVAL) return controls;
    if (error != 0) continue;
    if (query.id <= before) return controls;  // A driver that gives the same ones again would never end.
    controls.push_back(query);
    id = query.id;
  }
}

}  // namespace robot_vision
