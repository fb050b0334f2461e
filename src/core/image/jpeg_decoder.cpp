#include <cstdio>  // needed by jpeglib.h, which does not include it

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

// This uses libjpeg's own interface, because that of TurboJPEG reports only the first warning (so that any damage after
// a harmless warning would pass), cannot limit the number of scans before version 2.1, and reads every header twice.

namespace robot_vision
{
namespace
{

/// The most scans of a progressive stream. Encoders write 10, the most thorough ones some 60; decoding a small stream
/// with very many would take minutes.
constexpr int kMaxScans = 100;

/// The most arbitrary bytes that may stand in front of a marker: hardware encoders write whole words, filled up with
/// whatever was there, and some webcams leave a byte or more before the restart markers of nearly every image.
constexpr int kMaxExtraBytes = 32;

/// Whether libjpeg has skipped only zeros and fill bytes. `end` is the end of the `skipped` bytes; libjpeg does not
/// count fill bytes.
bool isPadding(const unsigned char* end, int skipped)
{
  const auto is_padding = [](unsigned char byte) { return byte == 0x00 || byte == 0xFF; };
  return std::all_of(end - skipped, end, is_padding);
}

/// Whether the image is complete in spite of a warning. After the start of a scan, bytes in front of a marker are what
/// damaged data leaves, unless they are the padding of a webcam; before the first scan they belong to nothing.
bool isHarmless(const jpeg_decompress_struct& info)
{
  const jpeg_error_mgr& warning = *info.err;
  const int skipped = warning.msg_parm.i[0];
  switch (warning.msg_code)
  {
    case JWRN_EXTRANEOUS_DATA:
      if (info.input_scan_number == 0) return true;
      return skipped <= kMaxExtraBytes || isPadding(info.src->next_input_byte, skipped);
    case JWRN_ADOBE_XFORM:
    case JWRN_JFIF_MAJOR:
    case JWRN_NOT_SEQUENTIAL:
      return true;
    default:
      return false;
  }
}

/// Decodes one stream with libjpeg. An error handler must not return to libjpeg: it jumps back to the last run(), and
/// the stack frames in between must not need destructors.
class Decompression
{
public:
  explicit Decompression(std::size_t size) : size_(size), what_("JPEG of " + std::to_string(size) + " bytes ")
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

  /// Throws std::invalid_argument for an image of more than kMaxPixels, too.
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
    requireDecodableSize(what_, info_.image_width, info_.image_height);
    return info_;
  }

  /// Runs calls of libjpeg. `work` must not hold anything that needs a destructor while libjpeg runs.
  template <class Work>
  void run(Work work)
  {
    if (setjmp(failed_) != 0) refuse("cannot be decoded: " + std::string(reason_.data()));
    work();
  }

  [[noreturn]] void refuse(const std::string& reason) const { throw std::invalid_argument(what_ + reason); }

private:
  static Decompression& of(j_common_ptr info) { return *static_cast<Decompression*>(info->client_data); }

  [[noreturn]] static void fail(j_common_ptr info)
  {
    Decompression& me = of(info);
    info->err->format_message(info, me.reason_.data());
    std::longjmp(me.failed_, 1);
  }

  void limitScans()
  {
    if (info_.input_scan_number <= kMaxScans) return;
    std::snprintf(reason_.data(), reason_.size(), "it has more than %d scans", kMaxScans);
    std::longjmp(failed_, 1);
  }

  std::size_t size_;
  std::string what_;  // how messages begin
  jpeg_decompress_struct info_{};
  jpeg_error_mgr errors_{};
  jpeg_progress_mgr progress_{};
  std::jmp_buf failed_{};
  std::array<char, JMSG_LENGTH_MAX> reason_{};
};

/// Whether no scan is missing. A stream may end after any of its scans; the parts whose scans are missing are then gray
/// or blurred.
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

void finish(Decompression& jpeg, jpeg_decompress_struct& info)
{
  if (!hasAllScans(info)) jpeg.refuse("is damaged: some of its scans are missing");
  jpeg.run([&info] { jpeg_finish_decompress(&info); });
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

/// Whether readLuma() can read the luma into the image directly: its rows consist of whole blocks, and it has the full
/// resolution.
bool isLumaOfBlocks(const jpeg_decompress_struct& info)
{
  const jpeg_component_info& luma = info.comp_info[0];
  const bool has_luma = info.jpeg_color_space == JCS_YCbCr || info.jpeg_color_space == JCS_GRAYSCALE;
  return has_luma && info.scale_denom == 1 && info.image_width % DCTSIZE == 0 &&
         luma.h_samp_factor == info.max_h_samp_factor && luma.v_samp_factor == info.max_v_samp_factor;
}

/// Makes libjpeg skip the chroma and write rows of blocks without copies. To be called before the decompression starts.
void requestLuma(jpeg_decompress_struct& info)
{
  info.raw_data_out = TRUE;
  for (int i = 1; i < info.num_components; ++i)
    info.comp_info[i].component_needed = FALSE;
}

/// Reads rows of blocks; `below` is room for the rows that the last blocks have below the image.
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

}  // namespace

void validateReduction(int reduction)
{
  require(reduction == 1 || reduction == 2 || reduction == 4 || reduction == 8, "reduction", reduction, "1, 2, 4 or 8");
}

void decodeJpeg(const unsigned char* data, std::size_t size, JpegPixels pixels, cv::Mat& out, int reduction)
{
  validateReduction(reduction);
  Decompression jpeg(size);
  jpeg_decompress_struct& info = jpeg.readHeader(data);
  const bool is_gray = pixels == JpegPixels::kGray;
  info.out_color_space = is_gray ? JCS_GRAYSCALE : pixels == JpegPixels::kRgb ? JCS_EXT_RGB : JCS_EXT_BGR;
  info.scale_num = 1;
  info.scale_denom = static_cast<unsigned>(reduction);
  const bool luma = is_gray && isLumaOfBlocks(info);
  if (luma) requestLuma(info);
  jpeg.run([&info] { jpeg_start_decompress(&info); });
  out.create(static_cast<int>(info.output_height), static_cast<int>(info.output_width), is_gray ? CV_8UC1 : CV_8UC3);
  std::vector<JSAMPLE> below(luma ? info.output_width : 0);
  if (luma)
    jpeg.run([&info, &out, &below] { readLuma(info, out, below); });
  else
    jpeg.run([&info, &out] { readRows(info, out); });
  finish(jpeg, info);
}

void requireSoundJpeg(const unsigned char* data, std::size_t size)
{
  Decompression jpeg(size);
  jpeg_decompress_struct& info = jpeg.readHeader(data);
  jpeg.run([&info] { jpeg_read_coefficients(&info); });
  finish(jpeg, info);
}

}  // namespace robot_vision
