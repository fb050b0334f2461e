#include <png.h>

#include <array>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <new>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "png.hpp"
#include "robot_vision/common/byte_order.hpp"

// This uses libpng's own interface, because OpenCV lets it print what is wrong with a stream: a line on the terminal
// for each image that somebody sends.

namespace robot_vision
{
namespace
{

/// Decodes one stream with libpng. An error handler must not return to libpng: it jumps back to the last run(), and the
/// stack frames in between must not need destructors.
class Decompression
{
public:
  Decompression(const unsigned char* data, std::size_t size) : next_(data), left_(size)
  {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, &fail, [](png_structp, png_const_charp) {});
    info_ = png_ == nullptr ? nullptr : png_create_info_struct(png_);
    if (info_ == nullptr)
    {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png_, this, &read);
  }

  ~Decompression() { png_destroy_read_struct(&png_, &info_, nullptr); }
  Decompression(const Decompression&) = delete;
  Decompression& operator=(const Decompression&) = delete;

  /// The size of the image, and OpenCV's type of it as it is stored.
  int readHeader(cv::Size& size)
  {
    run([this] { png_read_info(png_, info_); });
    size = {static_cast<int>(png_get_image_width(png_, info_)), static_cast<int>(png_get_image_height(png_, info_))};
    const int color = png_get_color_type(png_, info_);
    const bool has_color = (color & PNG_COLOR_MASK_COLOR) != 0;
    const bool has_key = has_color && png_get_valid(png_, info_, PNG_INFO_tRNS) != 0;  // colors that are transparent
    const int channels = (color & PNG_COLOR_MASK_ALPHA) != 0 || has_key ? 4 : has_color ? 3 : 1;
    return CV_MAKETYPE(png_get_bit_depth(png_, info_) == 16 ? CV_16U : CV_8U, channels);
  }

  /// The pixels into an image of another type, or of the same, as OpenCV converts them.
  void readPixels(cv::Mat& image)
  {
    run([this, &image] { request(image.depth(), image.channels()); });
    if (png_get_rowbytes(png_, info_) != static_cast<std::size_t>(image.cols) * image.elemSize())
      throw std::logic_error("a row of a PNG");
    std::vector<png_bytep> rows;
    for (int y = 0; y < image.rows; ++y)
      rows.push_back(image.ptr(y));
    run([this, &rows] { png_read_image(png_, rows.data()); });
    run([this] { png_read_end(png_, nullptr); });
  }

private:
  /// `work` must not hold anything that needs a destructor while libpng runs.
  template <class Work>
  void run(Work work)
  {
    if (setjmp(failed_) != 0) throw std::invalid_argument(reason_.data());
    work();
  }

  void request(int depth, int channels)
  {
    const int color = png_get_color_type(png_, info_), bits = png_get_bit_depth(png_, info_);
    const bool has_color = (color & PNG_COLOR_MASK_COLOR) != 0;
    if (depth == CV_8U && bits == 16)
      png_set_strip_16(png_);
    else if (isLittleEndianHost())
      png_set_swap(png_);
    if (channels < 4)
      png_set_strip_alpha(png_);
    else
      png_set_tRNS_to_alpha(png_);
    if (color == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png_);
    if (!has_color && bits < 8) png_set_expand_gray_1_2_4_to_8(png_);
    if (channels == 1)
      png_set_rgb_to_gray(png_, PNG_ERROR_ACTION_NONE, 0.299, 0.587);
    else if (has_color)
      png_set_bgr(png_);
    else
      png_set_gray_to_rgb(png_);
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
  }

  [[noreturn]] static void fail(png_structp png, png_const_charp reason)
  {
    auto& me = *static_cast<Decompression*>(png_get_error_ptr(png));
    std::snprintf(me.reason_.data(), me.reason_.size(), "%s", reason);
    std::longjmp(me.failed_, 1);
  }

  static void read(png_structp png, png_bytep out, std::size_t count)
  {
    auto& me = *static_cast<Decompression*>(png_get_io_ptr(png));
    if (count > me.left_) png_error(png, "it is truncated");
    std::memcpy(out, me.next_, count);
    me.next_ += count;
    me.left_ -= count;
  }

  const unsigned char* next_;
  std::size_t left_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::jmp_buf failed_{};
  std::array<char, 128> reason_{};
};

/// The type that cv::imdecode has for an image that is stored as `type`.
int typeFor(int type, int flags)
{
  if (flags == cv::IMREAD_UNCHANGED) return type;
  const int depth = (flags & cv::IMREAD_ANYDEPTH) != 0 ? CV_MAT_DEPTH(type) : CV_8U;
  const bool color = (flags & cv::IMREAD_COLOR) != 0 || ((flags & cv::IMREAD_ANYCOLOR) != 0 && CV_MAT_CN(type) > 1);
  return CV_MAKETYPE(depth, color ? 3 : 1);
}

}  // namespace

cv::Mat decodePng(const unsigned char* data, std::size_t size, int flags)
{
  readPngInfo(data, size);  // libpng would allocate any size that is claimed
  const std::vector<std::uint8_t> stream = withoutMetadata(data, size);
  try
  {
    Decompression png(stream.data(), stream.size());
    cv::Size pixels;
    const int type = png.readHeader(pixels);
    cv::Mat image(pixels, typeFor(type, flags));
    png.readPixels(image);
    return image;
  }
  catch (const std::invalid_argument& e)
  {
    throw std::invalid_argument("PNG of " + std::to_string(size) + " bytes cannot be decoded: " + e.what());
  }
}

}  // namespace robot_vision
