#include "code_search.hpp"

#include <algorithm>
#include <array>
#include <new>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <utility>

#include "robot_vision/common/printable.hpp"
#include "robot_vision/common/range.hpp"

namespace robot_vision
{
namespace
{

// DataBar is left out: zbar prints warnings for images that contain none, and in versions that are still in use its
// decoder writes beyond an array (CVE-2023-40890).
constexpr std::array<std::pair<const char*, zbar::zbar_symbol_type_t>, 10> kSymbologies = {{
    {"qr", zbar::ZBAR_QRCODE},
    {"ean13", zbar::ZBAR_EAN13},
    {"ean8", zbar::ZBAR_EAN8},
    {"upca", zbar::ZBAR_UPCA},
    {"upce", zbar::ZBAR_UPCE},
    {"code128", zbar::ZBAR_CODE128},
    {"code93", zbar::ZBAR_CODE93},
    {"code39", zbar::ZBAR_CODE39},
    {"i25", zbar::ZBAR_I25},
    {"codabar", zbar::ZBAR_CODABAR},
}};

/// Splits a list at its commas, and removes blanks.
std::vector<std::string> splitList(const std::string& list)
{
  std::vector<std::string> words(1);
  for (const char letter : list)
    if (letter == ',')
      words.emplace_back();
    else if (letter != ' ')
      words.back() += letter;
  return words;
}

// A single line may look like a bar code by chance, because not all symbologies have a check digit.
constexpr int kMinLines = 2;

// The name of an option for which the headers of older versions of zbar have no constant.
constexpr const char* kBinaryOption = "qrcode.binary";

std::map<zbar::zbar_symbol_type_t, std::string> wantedTypes(const std::string& symbologies)
{
  const std::vector<std::string> names = splitList(symbologies);
  std::map<zbar::zbar_symbol_type_t, std::string> wanted;
  for (const auto& [name, type] : kSymbologies)
    if (symbologies == "all" || std::find(names.begin(), names.end(), name) != names.end()) wanted[type] = name;
  return wanted;
}

/// The polygon of a code in the image, of which a part from `origin` on was enlarged and searched.
std::vector<cv::Point2d> polygonOf(const zbar::zbar_symbol_t* symbol, double enlarged, const cv::Point2f& origin)
{
  // zbar counts from the edges of pixels instead of their centres, but rounds down, which cancels out on average.
  const auto scaled = [enlarged](int position) { return static_cast<float>((position + 0.5) / enlarged - 0.5); };
  std::vector<cv::Point2f> points;
  for (unsigned i = 0; i < zbar::zbar_symbol_get_loc_size(symbol); ++i)
    points.push_back(origin + cv::Point2f(scaled(zbar::zbar_symbol_get_loc_x(symbol, i)),
                                          scaled(zbar::zbar_symbol_get_loc_y(symbol, i))));
  if (zbar::zbar_symbol_get_type(symbol) == zbar::ZBAR_QRCODE)  // zbar has the corners counter-clockwise
    return {points.at(0), points.at(3), points.at(2), points.at(1)};
  std::array<cv::Point2f, 4> corners;
  cv::minAreaRect(points).points(corners.data());
  return {corners.begin(), corners.end()};
}

}  // namespace

std::vector<std::string> codeTypes()
{
  std::vector<std::string> names;
  for (const auto& type : kSymbologies)
    names.emplace_back(type.first);
  return names;
}

bool keepsBytes()
{
  zbar::zbar_symbol_type_t type = zbar::ZBAR_NONE;
  zbar::zbar_config_t option = zbar::ZBAR_CFG_ENABLE;
  int value = 0;
  return zbar::zbar_parse_config(kBinaryOption, &type, &option, &value) == 0;
}

void validate(const CodeReaderParams& params)
{
  const std::vector<std::string> known = codeTypes();
  if (params.symbologies != "all")
    for (const std::string& name : splitList(params.symbologies))
      if (std::find(known.begin(), known.end(), name) == known.end())
        throw std::invalid_argument("symbologies has '" + shortened(name) +
                                    "', must be all, or some with commas: " + joined(known));
  checkFields(params);
}

CodeSearch::CodeSearch(const CodeReaderParams& params)
  : scanner_(zbar::zbar_image_scanner_create()),
    image_(zbar::zbar_image_create()),
    wanted_(wantedTypes(params.symbologies)),
    enlarge_(params.enlarge)
{
  if (!scanner_ || !image_) throw std::bad_alloc();
  set(zbar::ZBAR_NONE, zbar::ZBAR_CFG_ENABLE, 0);
  for (const auto& type : wanted_)
    set(type.first, zbar::ZBAR_CFG_ENABLE, 1);
  // zbar reads UPC-A as a kind of EAN-13.
  if (wanted_.count(zbar::ZBAR_UPCA)) set(zbar::ZBAR_EAN13, zbar::ZBAR_CFG_ENABLE, 1);
  set(zbar::ZBAR_NONE, zbar::ZBAR_CFG_X_DENSITY, params.spacing);
  set(zbar::ZBAR_NONE, zbar::ZBAR_CFG_Y_DENSITY, params.spacing);
  zbar::zbar_image_scanner_parse_config(scanner_.get(), kBinaryOption);
  zbar::zbar_image_set_format(image_.get(), zbar_fourcc('Y', '8', '0', '0'));
}

void CodeSearch::set(zbar::zbar_symbol_type_t type, zbar::zbar_config_t option, int value)
{
  zbar::zbar_image_scanner_set_config(scanner_.get(), type, option, value);
}

/// The pixels, enlarged, with rows that follow each other without gaps.
cv::Mat CodeSearch::prepare(const cv::Mat& pixels)
{
  if (enlarge_ == 1 && pixels.isContinuous()) return pixels;
  if (enlarge_ == 1)
    pixels.copyTo(copy_);
  else
    cv::resize(pixels, copy_, {}, enlarge_, enlarge_, cv::INTER_CUBIC);
  return copy_;
}

std::vector<Code> CodeSearch::find(const cv::Mat& gray, const cv::Rect& part)
{
  const cv::Mat pixels = prepare(gray(part));
  zbar::zbar_image_t* const image = image_.get();
  zbar::zbar_image_set_size(image, static_cast<unsigned>(pixels.cols), static_cast<unsigned>(pixels.rows));
  zbar::zbar_image_set_data(image, pixels.data, pixels.total(), nullptr);
  zbar::zbar_scan_image(scanner_.get(), image);
  std::vector<Code> codes;
  for (const auto* symbol = zbar::zbar_image_first_symbol(image); symbol; symbol = zbar::zbar_symbol_next(symbol))
  {
    const auto type = wanted_.find(zbar::zbar_symbol_get_type(symbol));
    if (type == wanted_.end()) continue;  // not asked for, or only a part of a code
    const bool is_qr = type->first == zbar::ZBAR_QRCODE;
    const int lines = zbar::zbar_symbol_get_quality(symbol);
    if (!is_qr && lines < kMinLines) continue;
    Code code;
    code.type = type->second;
    code.data.assign(zbar::zbar_symbol_get_data(symbol), zbar::zbar_symbol_get_data_length(symbol));
    code.polygon = polygonOf(symbol, enlarge_, part.tl());
    code.score = is_qr ? 1.0 : lines / (lines + 4.0);
    codes.push_back(code);
  }
  zbar::zbar_image_set_data(image, nullptr, 0, nullptr);  // the pixels belong to the caller
  return codes;
}

}  // namespace robot_vision
