#include "arrays.hpp"
#include "leave_gil.hpp"
#include "registry.hpp"
#include "robot_vision/codecs/compressed_depth.hpp"
#include "robot_vision/codecs/compressed_image.hpp"
#include "robot_vision/codecs/image_file.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace codecs_bindings
{

/// Bytes of Python, which must outlive this.
struct ByteView
{
  explicit ByteView(const py::buffer& buffer) : info(buffer.request())
  {
    if (info.ndim != 1 || info.strides[0] != info.itemsize) throw py::value_error("expected bytes in a row");
  }

  const unsigned char* data() const { return static_cast<const unsigned char*>(info.ptr); }
  std::size_t size() const { return static_cast<std::size_t>(info.size * info.itemsize); }

  py::buffer_info info;
};

py::array decodeFile(const py::buffer& data, int flags)
{
  const ByteView bytes(data);
  const cv::Mat image = withoutGil([&] { return decodeImageFile(bytes.data(), bytes.size(), flags); });
  if (image.empty()) throw py::value_error("no image that OpenCV can read");
  return toPython(image);
}

py::array decodeDepth(const std::string& format, const py::buffer& data)
{
  const ByteView bytes(data);
  cv::Mat depth;
  withoutGil([&] { decompressDepth(format, bytes.data(), bytes.size(), depth); });
  return toPython(depth);
}

std::tuple<std::string, int, int> infoOf(const py::buffer& data)
{
  const ByteView bytes(data);
  const CompressedInfo info = withoutGil([&] { return readCompressedInfo(bytes.data(), bytes.size()); });
  return {info.format, info.size.width, info.size.height};
}

void bindCodecs(py::module& m)
{
  m.def("decode_image_file", &decodeFile, "data"_a, "flags"_a,
        "The image of a file's bytes, read with cv2.IMREAD_... flags.\n\n"
        "Raises ValueError if it is none, or damaged, or if its header claims more pixels than fit into memory beside "
        "others.");
  m.def("compressed_info", &infoOf, "data"_a,
        "What the bytes of a compressed image are, without decoding them: (format, width, height), of which the format "
        "is jpeg or png and the size is in px.\n\n"
        "Raises ValueError if they are neither, not complete, without pixels, or claim too many.");
  m.def("decompress_depth", &decodeDepth, "format"_a, "data"_a,
        "The depths of a sensor_msgs/CompressedImage of the transport compressedDepth, by its fields `format` and "
        "`data`: (height, width) uint16 in mm, 0 where there is none, or float32 in m, NaN where there is none.\n\n"
        "Raises ValueError if the data is damaged, too large or not what `format` says.");
}

const Bindings kBindings("codecs", {}, bindCodecs);

}  // namespace codecs_bindings
