#include "arrays.hpp"
#include "leave_gil.hpp"
#include "registry.hpp"
#include "robot_vision/codecs/image_file.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace
{

py::array decodeFile(const py::buffer& data, int flags)
{
  const py::buffer_info bytes = data.request();
  if (bytes.ndim != 1 || bytes.strides[0] != bytes.itemsize) throw py::value_error("expected bytes in a row");
  const auto size = static_cast<std::size_t>(bytes.size * bytes.itemsize);
  const cv::Mat image =
      withoutGil([&] { return decodeImageFile(static_cast<const unsigned char*>(bytes.ptr), size, flags); });
  if (image.empty()) throw py::value_error("no image that OpenCV can read");
  return toPython(image);
}

void bindCodecs(py::module& m)
{
  m.def("decode_image_file", &decodeFile, "data"_a, "flags"_a,
        "The image of a file's bytes, read with cv2.IMREAD_... flags.\n\n"
        "Raises ValueError if it is none, or damaged, or if its header claims more pixels than fit into memory beside "
        "others.");
}

const Bindings kBindings("codecs", {}, bindCodecs);

}  // namespace
