#include <cstdio>  // what jpeglib.h needs of it, it does not include

#include <jpeglib.h>

#include <jerror.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <stdexcept>
#include <string>
#include <vector>

#include "robot_vision/common/range.hpp"
#include "robot_vision/image/jpeg.hpp"

// libjpeg-turbo by its older interface: that of TurboJPEG tells of the first warning only, so that behind a harmless
// one any damage would pass, knows of no limit of scans before version 2.1, and reads every header twice.

namespace robot_vision
{
namespace
{

/// Of a progressive picture; encoders write 10, the most thorough some 60. A small stream of many takes minutes.
constexpr int kMaxScans = 100;

/// Bytes in front of a marker that may be anything: encoders in hardware write whole words, as they find them, and
/// some webcams leave a byte or more before the restart markers of nearly every picture.
constexpr int kMaxLeftOver = 32;

/// Whether no more than zeros and fill bytes lie behind what has been decoded. libjpeg tells how many bytes it has
/// skipped (fill bytes do not count), and has come to the end of those.
bool isPadding(const unsigned char* end, int skipped)
{
  const auto pads = [](unsigned char byte) { return byte == 0x00 || byte == 0xFF; };
  return std::all_of(end - skipped, end, pads);
}

/// Whether the picture is whole nevertheless. Behind the begin of a scan, a gap in front of a marker is the trace of
/// damaged data, unless it is what webcams pad their streams with; in front of the first, it belongs to nothing.
bool isHarmless(const jpeg_decompress_struct& info)
{
  const jpeg_error_mgr& warning = *info.err;
  const int skipped = warning.msg_parm.i[0];
  switch (warning.msg_code)
  {
    case JWRN_EXTRANEOUS_DATA:
      if (info.input_scan_number == 0) return true;
      return skipped <= kMaxLeftOver || isPadding(info.src->next_input_byte, skipped);
    case JWRN_ADOBE_XFORM:
    case JWRN_JFIF_MAJOR:
    case JWRN_NOT_SEQUENTIAL:
      return true;
    default:
      return false;
  }
}

/// One picture's way through libjpeg, whose errors must not return to it: they go back to the last run(), over frames
/// without destructors.
class Decompression
{
public:
  explicit Decompression(std::size_t size) : size_(size)
  {
    info_.err = jpeg_std_error(&errors_);
    info_.client_data = this;
    errors_.error_exit = [](j_common_ptr info) { fail(info); };
    errors_.emit_message = [](j_common_ptr info, int level)
    {
      if (level < 0 && !isHarmless(of(info).info_)) fail(info);
    };
    progress_.progress_monitor = [](j_common_ptr info) { of(info).limitScans(); };
  }

  ~Decompression() { jpeg_destroy_decompress(&info_); }
  Decompression(const Decompression&) = delete;
  Decompression& operator=(const Decompression&) = delete;

  jpeg_decompress_struct& readHeader(const unsigned char* data)
  {
    run(
        [this, data]
        {
          jpeg_create_decompress(&info_);
          info_.progress = &progress_;
          jpeg_mem_src(&info_, data, static_cast<unsigned long>(size_));
          jpeg_read_header(&info_, TRUE);
        });
    return info_;
  }

  /// `work` may have nothing to destroy.
  template <class Work>
  void run(Work work)
  {
    if (setjmp(failed_) != 0) refuse("cannot be decoded: " + std::string(why_.data()));
    work();
  }

  [[noreturn]] void refuse(const std::string& why) const
  {
    throw std::invalid_argument("JPEG of " + std::to_string(size_) + " bytes " + why);
  }

private:
  static Decompression& of(j_common_ptr info) { return *static_cast<Decompression*>(info->client_data); }

  [[noreturn]] static void fail(j_common_ptr info)
  {
    Decompression& me = of(info);
    info->err->format_message(info, me.why_.data());
    std::longjmp(me.failed_, 1);
  }

  void limitScans()
  {
    if (info_.input_scan_number <= kMaxScans) return;
    std::snprintf(why_.data(), why_.size(), "it has more than %d scans", kMaxScans);
    std::longjmp(failed_, 1);
  }

  std::size_t size_;
  jpeg_decompress_struct info_{};
  jpeg_error_mgr errors_{};
  jpeg_progress_mgr progress_{};
  std::jmp_buf failed_{};
  std::array<char, JMSG_LENGTH_MAX> why_{};
};

void requireSize(const Decompression& picture, std::size_t width, std::size_t height)
{
  if (width * height > kMaxPixels)
    picture.refuse("claims to be of " + std::to_string(width) + "x" + std::to_string(height) + ", the most is " +
                   std::to_string(kMaxPixels) + " pixels");
}

/// A stream may end behind any of its scans; what is missing then is gray, or blurred.
bool hasAllScans(const jpeg_decompress_struct& info)
{
  for (int i = 0; i < info.num_components; ++i)
  {
    if (info.comp_info[i].quant_table == nullptr) return false;
    if (info.progressive_mode == FALSE) continue;
    const int* const missing_bits = info.coef_bits[i];
    if (std::any_of(missing_bits, missing_bits + DCTSIZE2, [](int bits) { return bits != 0; })) return false;
  }
  return true;
}

void finish(Decompression& picture, jpeg_decompress_struct& info)
{
  if (!hasAllScans(info)) picture.refuse("is damaged: some of its scans are missing");
  picture.run([&info] { jpeg_finish_decompress(&info); });
}

void readRows(jpeg_decompress_struct& info, cv::Mat& out)
{
  std::array<JSAMPROW, 16> rows;
  while (info.output_scanline < info.output_height)
  {
    const JDIMENSION count = std::min(info.output_height - info.output_scanline, static_cast<JDIMENSION>(rows.size()));
    for (JDIMENSION i = 0; i < count; ++i)
      rows[i] = out.ptr(static_cast<int>(info.output_scanline + i));
    jpeg_read_scanlines(&info, rows.data(), count);
  }
}

/// Whether readLuma() can put the luma where it belongs: whole blocks across, and as fine as the picture.
bool isLumaOfBlocks(const jpeg_decompress_struct& info)
{
  const jpeg_component_info& luma = info.comp_info[0];
  const bool has_luma = info.jpeg_color_space == JCS_YCbCr || info.jpeg_color_space == JCS_GRAYSCALE;
  return has_luma && info.scale_denom == 1 && info.image_width % DCTSIZE == 0 &&
         luma.h_samp_factor == info.max_h_samp_factor && luma.v_samp_factor == info.max_v_samp_factor;
}

/// To be called before the decompression starts: it then leaves the chroma alone, and copies no rows.
void wantLuma(jpeg_decompress_struct& info)
{
  info.raw_data_out = TRUE;
  for (int i = 1; i < info.num_components; ++i)
    info.comp_info[i].component_needed = FALSE;
}

void readLuma(jpeg_decompress_struct& info, cv::Mat& out, std::vector<JSAMPLE>& below)
{
  std::array<JSAMPROW, MAX_SAMP_FACTOR * DCTSIZE> rows;
  std::array<JSAMPARRAY, MAX_COMPONENTS> planes{rows.data()};
  while (info.output_scanline < info.output_height)
  {
    const int first = static_cast<int>(info.output_scanline);
    for (int i = 0; i < static_cast<int>(rows.size()); ++i)
      rows[i] = first + i < out.rows ? out.ptr(first + i) : below.data();
    jpeg_read_raw_data(&info, planes.data(), static_cast<JDIMENSION>(rows.size()));
  }
}

J_COLOR_SPACE colorSpace(JpegPixels pixels)
{
  switch (pixels)
  {
    case JpegPixels::kGray:
      return JCS_GRAYSCALE;
    case JpegPixels::kRgb:
      return JCS_EXT_RGB;
    default:
      return JCS_EXT_BGR;
  }
}

}  // namespace

void validateReduction(int reduction)
{
  require(reduction == 1 || reduction == 2 || reduction == 4 || reduction == 8, "reduction", reduction, "1, 2, 4 or 8");
}

void decodeJpeg(const unsigned char* data, std::size_t size, JpegPixels pixels, cv::Mat& out, int reduction)
{
  validateReduction(reduction);
  Decompression picture(size);
  jpeg_decompress_struct& info = picture.readHeader(data);
  requireSize(picture, info.image_width, info.image_height);
  info.out_color_space = colorSpace(pixels);
  info.scale_num = 1;
  info.scale_denom = static_cast<unsigned>(reduction);
  const bool luma = pixels == JpegPixels::kGray && isLumaOfBlocks(info);
  if (luma) wantLuma(info);
  picture.run([&info] { jpeg_start_decompress(&info); });
  out.create(static_cast<int>(info.output_height), static_cast<int>(info.output_width),
             pixels == JpegPixels::kGray ? CV_8UC1 : CV_8UC3);
  std::vector<JSAMPLE> below(luma ? info.output_width : 0);  // what the last blocks have below the picture
  if (luma)
    picture.run([&info, &out, &below] { readLuma(info, out, below); });
  else
    picture.run([&info, &out] { readRows(info, out); });
  finish(picture, info);
}

void requireSoundJpeg(const unsigned char* data, std::size_t size)
{
  Decompression picture(size);
  jpeg_decompress_struct& info = picture.readHeader(data);
  requireSize(picture, info.image_width, info.image_height);
  picture.run([&info] { jpeg_read_coefficients(&info); });
  finish(picture, info);
}

}  // namespace robot_vision
