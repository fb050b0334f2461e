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

/// Whether the bytes of a QR code are returned unchanged, which needs zbar 0.23.1 (Ubuntu 20.04 has 0.23.0). Older
/// versions guess the character set and convert it to UTF-8, so that bytes beyond ASCII may be changed.
bool keepsBytes();

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range.
void validate(const CodeReaderParams& params);

/// A code in an image.
struct Code
{
  std::string type;  // one of codeTypes()
  std::string data;  // its content; bytes may have any value
  /// px from the centre of the top left pixel. For a QR code these are the corners of its modules, clockwise from the
  /// code's own top left corner; for a bar code a rectangle around the ends of the lines along which it was read, which
  /// begins at any corner.
  std::vector<cv::Point2d> polygon;
  double score = 0.0;  // 0 to 1: 1 for a QR code, which corrects its errors; n / (n + 4) if n lines of a bar code agree
};

/// Reads QR codes and bar codes with zbar.
///
/// read() searches the whole image. update() searches the whole image only from time to time, so that new codes are
/// found within max_search_period, and when a code is lost; in the other frames it searches around the known codes. A
/// code is reported only if it was read in this very frame.
///
/// If whole images are searched in the background, update() does not wait for that search. The codes that it has found
/// are then searched for in the newest frame, and reported there. A new code appears later by the time of a search and
/// a frame, and results depend on the speed of the machine, so that this is for live images. update() itself searches
/// the first frame, the first of another size, the first after time went back, and every frame if max_search_period is
/// 0.
///
/// A bar code is reported if at least two lines across it agree; for EAN, UPC and Codabar zbar itself requires four.
/// Bar codes of the same type and content count as one code, wherever they are in the image. QR codes do not, but those
/// that are parts of one content (structured append) are one code if all parts are there, and none otherwise. Bytes
/// whose character set a QR code names (ECI) become UTF-8. Not thread-safe.
class CodeReader
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit CodeReader(const CodeReaderParams& params = CodeReaderParams());
  ~CodeReader();
  CodeReader(CodeReader&&) noexcept;
  CodeReader& operator=(CodeReader&&) noexcept;

  /// Reads the codes of a single image, from top to bottom. `image` is not modified. Throws std::invalid_argument if it
  /// is not of `encoding` (see encoding.hpp).
  std::vector<Code> read(const cv::Mat& image, const std::string& encoding);

  /// Reads the codes of the frame at `time_s` (s, of any clock), in the same order. It forgets all codes if the size of
  /// the image has changed, or if time goes back or stands still. Throws as read() does, and for a time that is not
  /// finite.
  std::vector<Code> update(double time_s, const cv::Mat& image, const std::string& encoding);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
