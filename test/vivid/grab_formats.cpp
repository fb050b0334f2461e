// Reads a frame of a device in each pixel format that it offers, by its name in pixel_format.
//
//   grab_formats DEVICE OUT
//
// OUT/<name>.native, .bgr8, .rgb8 and .mono8 get its pixels; a line of the output says: name, encoding of .native,
// source.

#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

#include "core/camera/v4l2_pixel_formats.hpp"
#include "robot_vision/camera/open_source.hpp"
#include "robot_vision/camera/output_encoding.hpp"
#include "robot_vision/image/encoding.hpp"

namespace
{

using namespace robot_vision;

constexpr int kTries = 600;  // of 0.1 s, for the machine may be emulated

Frame firstFrame(FrameSource& source)
{
  Frame frame;
  for (int i = 0; i < kTries; ++i)
    if (source.read(frame) == ReadResult::kFrame) return frame;
  throw std::runtime_error("no frame");
}

void write(const std::string& path, const Frame& frame, const std::string& encoding)
{
  cv::Mat pixels;
  toEncoding(frame.image, frame.encoding, encoding, pixels);
  std::ofstream file(path, std::ios::binary);
  for (int row = 0; row < pixels.rows; ++row)
    file.write(pixels.ptr<char>(row), static_cast<std::streamsize>(pixels.cols * pixels.elemSize()));
}

void grab(const std::string& name, const std::string& device, const std::string& out)
{
  CaptureParams params;
  params.video_device = device;
  params.pixel_format = name;
  const auto source = openSource(params);
  if (!source->warning().empty()) throw std::runtime_error(source->warning());
  const Frame frame = firstFrame(*source);
  const std::string native = outputEncoding("native", frame.encoding);
  write(out + "/" + name + ".native", frame, native);
  for (const char* encoding : {"bgr8", "rgb8", "mono8"})
    write(out + "/" + name + "." + encoding, frame, encoding);
  std::cout << name << ", " << native << ", " << source->description() << std::endl;
}

}  // namespace

int main(int argc, char** argv)
{
  if (argc != 3) return 2;
  int failed = 0;
  for (const V4l2Format& format : kV4l2Formats)
  {
    if (format.compressed || findV4l2Format(format.fourcc) != &format) continue;
    if (isDepthEncoding(format.encoding) || format.fourcc == V4L2_PIX_FMT_Y10BPACK) continue;  // vivid has neither
    try
    {
      grab(format.name, argv[1], argv[2]);
    }
    catch (const std::exception& e)
    {
      std::cout << format.name << ": " << e.what() << std::endl;
      ++failed;
    }
  }
  return failed == 0 ? 0 : 1;
}
