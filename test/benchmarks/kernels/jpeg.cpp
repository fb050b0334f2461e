#include "robot_vision/image/jpeg.hpp"

#include <memory>
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
  explicit Frame(const cv::Mat& picture) : bgr(picture)
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
  Results pictures;
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

bool samePictures(const Outcome& outcome)
{
  return outcome.pictures.same();
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
  robot_vision::decodeJpeg(frame.jpeg.data(), frame.jpeg.size(), pixels, to.pictures.ours, reduction);
}

template <int flags>
void imdecode(const Frame& frame, Outcome& to)
{
  cv::imdecode(frame.jpeg, flags, &to.pictures.theirs);
}

void imdecodeToRgb(const Frame& frame, Outcome& to)
{
  cv::imdecode(frame.jpeg, cv::IMREAD_COLOR, &to.swapped);
  cv::cvtColor(to.swapped, to.pictures.theirs, cv::COLOR_BGR2RGB);
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
    {"JPEG to bgr8", "imdecode", 1.0, imdecode<cv::IMREAD_COLOR>, kDecode, samePictures},
    {"JPEG to rgb8", "imdecode, cvtColor", 1.0, imdecodeToRgb, decode<JpegPixels::kRgb>, samePictures},
    {"JPEG to mono8", "imdecode", 1.0, imdecode<cv::IMREAD_GRAYSCALE>, kDecodeLuma, samePictures},
    {"bgr8 to JPEG", "imencode", 1.0, imencode<&Frame::bgr>, encode<&Frame::bgr>, sameBytes},
    {"rgb8 to JPEG", "cvtColor, imencode", 1.0, imencodeFromRgb, encode<&Frame::rgb>, sameBytes},
    {"mono8 to JPEG", "imencode", 1.0, imencode<&Frame::gray>, encode<&Frame::gray>, sameBytes},
};

Contest prepare(const Case& c, const Setup& setup)
{
  struct State
  {
    std::vector<Frame> frames;
    Outcome outcome;
  };
  const auto state = std::make_shared<State>();
  for (const cv::Mat& frame : setup.frames)
    state->frames.emplace_back(frame);
  return {[=](std::size_t i) { c.theirs(state->frames[i], state->outcome); },
          [=](std::size_t i) { c.ours(state->frames[i], state->outcome); }, [=] { return c.same(state->outcome); }};
}

}  // namespace

std::vector<Work> jpegWorks()
{
  std::vector<Work> works;
  for (const Case& c : kCases)
    works.push_back({c.name, c.against, c.goal, [c](const Setup& setup) { return prepare(c, setup); }});
  return works;
}

}  // namespace bench
