#pragma once

#include <zbar.h>

#include <map>
#include <memory>

#include "robot_vision/codes/code_reader.hpp"

namespace robot_vision
{

/// Searches images for codes with a scanner of zbar. Not thread-safe.
class CodeSearch
{
public:
  /// The parameters must be valid.
  explicit CodeSearch(const CodeReaderParams& params);

  /// Finds the codes in a part of a gray image. Keeps nothing of the image.
  std::vector<Code> find(const cv::Mat& gray, const cv::Rect& part);

private:
  struct Free
  {
    void operator()(zbar::zbar_image_scanner_t* scanner) const { zbar::zbar_image_scanner_destroy(scanner); }
    void operator()(zbar::zbar_image_t* image) const { zbar::zbar_image_destroy(image); }
  };

  void set(zbar::zbar_symbol_type_t type, zbar::zbar_config_t option, int value);
  cv::Mat prepare(const cv::Mat& pixels);

  std::unique_ptr<zbar::zbar_image_scanner_t, Free> scanner_;
  std::unique_ptr<zbar::zbar_image_t, Free> image_;
  std::map<zbar::zbar_symbol_type_t, std::string> wanted_;  // the names of the types to report
  int enlarge_;
  cv::Mat copy_;  // memory for pixels that zbar cannot be given as they are
};

}  // namespace robot_vision
