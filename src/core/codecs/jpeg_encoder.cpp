#include <turbojpeg.h>

#include <algorithm>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "opencv_codecs.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/jpeg.hpp"

namespace robot_vision
{
namespace
{

using Handle = std::unique_ptr<void, int (*)(tjhandle)>;
using Buffer = std::unique_ptr<unsigned char, void (*)(unsigned char*)>;

/// The handle of this thread. Threads must not share one, and making one costs more than encoding a small image.
Handle& encoder()
{
  thread_local Handle handle(nullptr, tjDestroy);
  if (!handle) handle.reset(tjInitCompress());
  if (!handle) throw std::runtime_error(std::string("no TurboJPEG: ") + tjGetErrorStr2(nullptr));
  return handle;
}

TJPF pixelFormat(const cv::Mat& image, bool rgb)
{
  switch (image.type())
  {
    case CV_8UC1:
      return TJPF_GRAY;
    case CV_8UC3:
      return rgb ? TJPF_RGB : TJPF_BGR;
    case CV_8UC4:
      return rgb ? TJPF_RGBX : TJPF_BGRX;
    default:
      throw std::invalid_argument("pixels of " + cv::typeToString(image.type()) +
                                  " cannot become JPEG, must be CV_8UC1, CV_8UC3 or CV_8UC4");
  }
}

/// Encodes with options that TurboJPEG does not have before version 3.
void encodeWithOptions(const cv::Mat& image, bool rgb, const JpegParams& params, std::vector<std::uint8_t>& out)
{
  cv::Mat bgr;
  if (image.channels() == 4)
    cv::cvtColor(image, bgr, rgb ? cv::COLOR_RGBA2BGR : cv::COLOR_BGRA2BGR);
  else if (image.channels() == 3 && rgb)
    cv::cvtColor(image, bgr, cv::COLOR_RGB2BGR);
  else
    bgr = image;
  encodeByOpenCv(
      ".jpg", bgr,
      {cv::IMWRITE_JPEG_QUALITY, params.quality, cv::IMWRITE_JPEG_PROGRESSIVE, params.progressive ? 1 : 0,
       cv::IMWRITE_JPEG_OPTIMIZE, params.optimize ? 1 : 0, cv::IMWRITE_JPEG_RST_INTERVAL, params.restart_interval},
      out);
}

}  // namespace

void encodeJpeg(const cv::Mat& image, bool rgb, const JpegParams& params, std::vector<std::uint8_t>& out)
{
  validate(params);
  const TJPF format = pixelFormat(image, rgb);
  if (image.empty() || image.total() > kMaxPixels || std::max(image.cols, image.rows) > kLongestJpegSide)
    throw std::invalid_argument("an image of " + toText(image.size()) +
                                " cannot become JPEG: it has no or too many pixels");
  if (params.optimize || params.progressive || params.restart_interval != 0)
    return encodeWithOptions(image, rgb, params, out);

  const int subsampling = format == TJPF_GRAY ? TJSAMP_GRAY : TJSAMP_420;
  thread_local Buffer buffer(nullptr, tjFree);
  thread_local unsigned long room = 0;
  const unsigned long max_size = tjBufSize(image.cols, image.rows, subsampling);
  if (max_size > room)
  {
    buffer.reset(tjAlloc(static_cast<int>(max_size)));
    room = buffer ? max_size : 0;
    if (!buffer) throw std::bad_alloc();
  }
  unsigned char* bytes = buffer.get();
  unsigned long size = room;
  Handle& handle = encoder();
  if (tjCompress2(handle.get(), image.data, image.cols, static_cast<int>(image.step), image.rows, format, &bytes, &size,
                  subsampling, params.quality, TJFLAG_NOREALLOC | TJFLAG_ACCURATEDCT) != 0)
    throw std::runtime_error(std::string("JPEG cannot be encoded: ") + tjGetErrorStr2(handle.get()));
  out.assign(bytes, bytes + size);
}

}  // namespace robot_vision
