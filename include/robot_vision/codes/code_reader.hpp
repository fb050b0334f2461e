#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct CodeReaderParams
{
  std::string symbologies = "all";
  int spacing = 1;
  int enlarge = 1;
  double max_search_period = 0.5;
  bool background = false;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("symbologies", &CodeReaderParams::symbologies, Anything{}, "",
          "what is looked for, each of which takes time: all, or some with commas: qr, ean13, ean8, upca, upce, "
          "code128, code93, code39, i25, codabar");
    visit("spacing", &CodeReaderParams::spacing, Range{1, 16}, "px",
          "distance of the lines that are scanned; more is faster and misses small codes");
    visit("enlarge", &CodeReaderParams::enlarge, Range{1, 4}, "",
          "times the image is enlarged first, for codes with modules below 3 px; takes the square of the time");
    visit("max_search_period", &CodeReaderParams::max_search_period, Range{0, 60}, "s",
          "time between searches of a whole image, which find new codes; 0: every frame is searched whole");
    visit("background", &CodeReaderParams::background, Anything{}, "",
          "search whole images in a thread of its own, while update() goes on");
  }
};

/// Names of the kinds of code that can be read: qr, ean13, ...
std::vector<std::string> codeTypes();

/// Whether the bytes of a QR code come back as they are, which takes zbar 0.23.1 (Ubuntu 20.04 has 0.23.0). Older ones
/// guess which character set they are of, and give UTF-8: what is not ASCII may come back changed.
bool keepsBytes();

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range.
void validate(const CodeReaderParams& params);

/// A code in a picture.
struct Code
{
  std::string type;  // one of codeTypes()
  std::string data;  // its content, byte by byte, of any value
  /// px from the centre of the top left pixel. Of a QR code the corners of its modules, clockwise from its own top left
  /// one; of a bar code a rectangle around the ends of the lines along which it was read, from any corner.
  std::vector<cv::Point2d> polygon;
  double score = 0.0;  // 0 to 1: 1 of a QR code, which corrects its errors; n / (n + 4) of n lines that agree
};

/// Reads QR codes and bar codes with zbar.
///
/// read() searches the whole image. update() does so every now and then, so that a new code is found within
/// max_search_period, and when a code is lost; in the frames between it searches around the codes that it knows. A code
/// is reported only where it was read in this very frame. In the background such a search takes no time of update();
/// what it finds is looked for in the newest frame, and reported there. A new code then appears later by the time of a
/// search and a frame, and results depend on how fast the machine is: for live images. The first frame, the first of
/// another size, and that after time went back are searched by update() itself, and so is every frame if
/// max_search_period is 0.
///
/// A bar code is what two lines across it agree on at least; zbar itself asks for four of EAN, UPC and Codabar.
/// Bar codes of one type and content count as one code, wherever they are in the picture; QR codes do not, but those
/// that are parts of one content (structured append) are one code if all are there, and else none. Bytes whose
/// character set a QR code names (ECI) come back as UTF-8. Not for two threads at once.
class CodeReader
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit CodeReader(const CodeReaderParams& params = CodeReaderParams());
  ~CodeReader();
  CodeReader(CodeReader&&) noexcept;
  CodeReader& operator=(CodeReader&&) noexcept;

  /// The codes in a picture by itself, from top to bottom. `image` is not modified. Throws std::invalid_argument if it
  /// is not a picture of `encoding` (see encoding.hpp).
  std::vector<Code> read(const cv::Mat& image, const std::string& encoding);

  /// The codes in the frame of `time_s` (s, of any clock), in the same order. Another size of image and time that goes
  /// back, or stands still, make it forget what it knows. Throws as read() does, and for a time that is not finite.
  std::vector<Code> update(double time_s, const cv::Mat& image, const std::string& encoding);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
