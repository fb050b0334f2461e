#include "robot_vision/image/jpeg.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "contests.hpp"

namespace bench
{
namespace
{

using robot_vision::JpegPixels;

using Bytes = std::vector<std::uint8_t>;

const std::vector<int> kOptions = {cv::IMWRITE_JPEG_QUALITY, 80};  // of compressed topics

/// One frame in all its forms.
struct Frame
{
  explicit Frame(const cv::Mat& image) : bgr(image)
  {
    cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
    cv::cvtColor(bgr, gray, cv::COLOR_BGR2GRAY);
    cv::imencode(".jpg", bgr, jpeg, kOptions);
  }

  cv::Mat bgr, rgb, gray;
  Bytes jpeg;
};

struct Outcome
{
  Results images;
  cv::Mat swapped;
  Bytes theirs, ours;
};

struct Case
{
  const char* name;
  const char* against;
  double goal;
  void (*theirs)(const Frame&, Outcome&);
  void (*ours)(const Frame&, Outcome&);
  bool (*same)(const Outcome&);
};

bool sameImages(const Outcome& outcome)
{
  return outcome.images.same();
}

bool sameBytes(const Outcome& outcome)
{
  return outcome.theirs == outcome.ours;
}

bool notCompared(const Outcome&)
{
  return true;
}

template <JpegPixels pixels, int reduction = 1>
void decode(const Frame& frame, Outcome& to)
{
  robot_vision::decodeJpeg(frame.jpeg.data(), frame.jpeg.size(), pixels, to.images.ours, reduction);
}

template <int flags>
void imdecode(const Frame& frame, Outcome& to)
{
  cv::imdecode(frame.jpeg, flags, &to.images.theirs);
}

void imdecodeToRgb(const Frame& frame, Outcome& to)
{
  cv::imdecode(frame.jpeg, cv::IMREAD_COLOR, &to.swapped);
  cv::cvtColor(to.swapped, to.images.theirs, cv::COLOR_BGR2RGB);
}

template <cv::Mat Frame::*image>
void encode(const Frame& frame, Outcome& to)
{
  robot_vision::encodeJpeg(frame.*image, image == &Frame::rgb, {}, to.ours);
}

template <cv::Mat Frame::*image>
void imencode(const Frame& frame, Outcome& to)
{
  cv::imencode(".jpg", frame.*image, to.theirs, kOptions);
}

void imencodeFromRgb(const Frame& frame, Outcome& to)
{
  cv::cvtColor(frame.rgb, to.swapped, cv::COLOR_RGB2BGR);
  cv::imencode(".jpg", to.swapped, to.theirs, kOptions);
}

void passOn(const Frame& frame, Outcome& to)
{
  robot_vision::copyJpeg(frame.jpeg.data(), frame.jpeg.size(), to.ours);
}

constexpr auto kDecode = decode<JpegPixels::kBgr>;
constexpr auto kDecodeLuma = decode<JpegPixels::kGray>;

const std::vector<Case> kCases = {
    {"JPEG passed on", "our decoder", 10.0, kDecode, passOn, notCompared},
    {"JPEG to its luma", "our decoder", 1.0, kDecode, kDecodeLuma, notCompared},
    {"JPEG to 1/2", "our decoder", 1.0, kDecode, decode<JpegPixels::kBgr, 2>, notCompared},
    {"JPEG to bgr8", "imdecode", 1.0, imdecode<cv::IMREAD_COLOR>, kDecode, sameImages},
    {"JPEG to rgb8", "imdecode, cvtColor", 1.0, imdecodeToRgb, decode<JpegPixels::kRgb>, sameImages},
    {"JPEG to mono8", "imdecode", 1.0, imdecode<cv::IMREAD_GRAYSCALE>, kDecodeLuma, sameImages},
    {"bgr8 to JPEG", "imencode", 1.0, imencode<&Frame::bgr>, encode<&Frame::bgr>, sameBytes},
    {"rgb8 to JPEG", "cvtColor, imencode", 1.0, imencodeFromRgb, encode<&Frame::rgb>, sameBytes},
    {"mono8 to JPEG", "imencode", 1.0, imencode<&Frame::gray>, encode<&Frame::gray>, sameBytes},
};

struct State
{
  State(const Setup& setup, const Case& of) : frames(setup.frames.begin(), setup.frames.end()), work(of) {}

  void byOpenCv(std::size_t i) { work.theirs(frames[i], outcome); }
  void byUs(std::size_t i) { work.ours(frames[i], outcome); }
  bool same() const { return work.same(outcome); }

  std::vector<Frame> frames;
  Case work;
  Outcome outcome;
};

}  // namespace

std::vector<Work> jpegWorks()
{
  std::vector<Work> works;
  for (const Case& c : kCases)
    works.push_back({c.name, c.against, c.goal, contestOf<State>(c)});
  return works;
}

}  // namespace bench
