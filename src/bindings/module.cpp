#include <opencv2/core/utility.hpp>

#include "leave_gil.hpp"
#include "registry.hpp"

using namespace robot_vision;
using namespace py::literals;

PYBIND11_MODULE(_core, m)
{
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
