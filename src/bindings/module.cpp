#include <malloc.h>

#include <cstdlib>
#include <opencv2/core/utility.hpp>

#include "leave_gil.hpp"
#include "registry.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace
{

/// Has all threads take their memory from two places. glibc would let each of the many threads of a process with
/// several nodes have one of its own, up to eight for each core, which keep what they once had: 60 MB in that of the
/// demo.
void limitArenas()
{
#ifdef M_ARENA_MAX
  if (std::getenv("MALLOC_ARENA_MAX") == nullptr) mallopt(M_ARENA_MAX, 2);
#endif
}

}  // namespace

PYBIND11_MODULE(_core, m)
{
  limitArenas();
  m.doc() =
      "The C++ core of robot_vision on NumPy arrays. Images are (height, width) or (height, width, channels) arrays of "
      "uint8 or, for 16-bit encodings, uint16. They are used without a copy if their pixels lie side by side in each "
      "row; rows may be padded.";
  LeaveGil::endWithProcess();
  Bindings::bindAll(m);
  m.def(
      "set_threads", [](int count) { cv::setNumThreads(count > 0 ? count : cv::getNumberOfCPUs()); }, "count"_a,
      "How many threads of OpenCV's share the work on one image, in this process; 0: as many as there are cores.");
}
