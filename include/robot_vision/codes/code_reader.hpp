#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace robot_vision
{

struct CodeReaderParams
{
  std::string symbologies = "all";  // what is looked for: all, or some of codeTypes() with commas between them
  int spacing = 1;                  // px between the lines along which the picture is scanned, 1 to 16
  int enlarge = 1;                  // times the picture is enlarged first, 1 to 4: zbar wants modules of 3 px and more
  double max_search_period = 0.5;   // s within which a new code is found, 0 (all of every image is searched) to 60
  bool background = false;          // search whole images in a thread of its own, while update() goes on
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
