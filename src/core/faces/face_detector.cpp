#include "robot_vision/faces/face_detector.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "changed_cells.hpp"
#include "core/image/histogram_equalization.hpp"
#include "core/image/rects.hpp"
#include "face_search.hpp"
#include "face_tracks.hpp"
#include "face_worker.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/image/encoding.hpp"

namespace robot_vision
{
namespace
{

constexpr int kCell = 8;               // px, side of what is compared to see where something moves
constexpr double kMaxParts = 0.3;      // of the picture, which is searched between searches of the whole
constexpr double kRest = 4.0;          // times as long as a search, until parts are searched again
constexpr double kMinRest = 0.1;       // s
constexpr double kLongestFrame = 0.1;  // s between frames of a stream that does not pause
constexpr double kSurprise = 1.25;     // by how much the next search may take longer than the last
constexpr int kEyeFace = 128;          // px, width to which a face is brought to look for its eyes
constexpr int kEyeNeighbors = 3;

}  // namespace

void validate(const FaceParams& params)
{
  require(!params.cascade_1.empty(), "cascade_1", "''", "the name of a file");
  checkFields(params);
  require(params.max_size == 0 || params.max_size >= params.min_size, "max_size", params.max_size,
          "0 (any) or from min_size (" + toText(params.min_size) + ") to 8192");
}

struct FaceDetector::Impl
{
  explicit Impl(const FaceParams& p)
    : params((validate(p), p)), near(p), worker(std::make_unique<FaceWorker>(p, p.background))
  {
    if (!p.eye_cascade.empty()) eyes = readCascade("eye_cascade", p.eye_cascade);
  }

  /// Whether the cascades that have been read, and the thread, are those that are wanted.
  bool reads(const FaceParams& p) const
  {
    return p.cascade_1 == params.cascade_1 && p.cascade_2 == params.cascade_2 && p.eye_cascade == params.eye_cascade &&
           p.background == params.background;
  }

  /// Returns the picture before equalisation; it may share the input's pixels.
  cv::Mat prepare(const cv::Mat& image, const std::string& encoding)
  {
    cv::Mat plain;
    if (params.equalize)
    {
      toEqualizedGray(image, encoding, plain, gray);
    }
    else
    {
      toGray(image, encoding, plain);
      plain.copyTo(gray);
    }
    return plain;
  }

  void forget()
  {
    tracks.clear();
    searched.reset();
    rest_until = 0.0;
    search_time = 0.0;
  }

  void takeResult()
  {
    const std::optional<FaceResult> result = worker->take();
    if (!result || result->job.gray.size() != gray.size() || result->job.time > time) return;
    if (result->job.whole) search_time = searching;
    rest_until = time + std::max(kRest * searching, kMinRest);
    tracks.add(*result, time, params);
  }

  void search()
  {
    if (worker->busy()) return;
    const double pause = std::max(params.max_search_period - kSurprise * search_time, 0.0);
    FaceJob job;
    job.time = time;
    job.whole = !searched || time - *searched >= pause;
    if (job.whole)
    {
      searched = time;
      moving.clear();
      job.parts = {cv::Rect({0, 0}, gray.size())};
      job.windows = FaceWindows::of(params);
    }
    else if (time >= rest_until)
      chooseParts(job);
    if (job.parts.empty()) return;
    job.gray = gray.clone();
    searching = 0.0;
    worker->start(std::move(job));
    if (!params.background) takeResult();
  }

  /// Where something moves that is no known face, if that is not too much.
  void chooseParts(FaceJob& job)
  {
    for (const cv::Rect& box : tracks.boxes())
      moving.ignore(grown(box, box.width / 2, gray.size()));
    job.windows = tracks.windows(params);
    job.parts = moving.take(params.min_size);
    double area = 0.0;
    for (const cv::Rect& part : job.parts)
      area += part.area();
    if (area > kMaxParts * static_cast<double>(gray.total())) job.parts.clear();
  }

  FaceParams params;
  FaceSearch near;  // around known faces
  std::unique_ptr<FaceWorker> worker;
  cv::CascadeClassifier eyes;
  FaceTracks tracks;
  ChangedCells moving{kCell};
  cv::Mat gray;                    // of the newest picture
  cv::Size size;                   // px, of the frames that are followed
  double time = 0.0;               // s, of the newest frame
  std::optional<double> searched;  // s, the frame of the last search of a whole picture
  double search_time = 0.0;        // s, of the same
  double searching = 0.0;          // s since the last search began, without pauses of the stream
  double rest_until = 0.0;         // s, no parts are searched before
};

FaceDetector::FaceDetector(const FaceParams& params) : impl_(std::make_unique<Impl>(params))
{
}
FaceDetector::~FaceDetector() = default;
FaceDetector::FaceDetector(FaceDetector&&) noexcept = default;
FaceDetector& FaceDetector::operator=(FaceDetector&&) noexcept = default;

void FaceDetector::configure(const FaceParams& params)
{
  validate(params);
  if (!impl_->reads(params))
  {
    auto next = std::make_unique<Impl>(params);
    next->tracks = std::move(impl_->tracks);
    next->gray = impl_->gray;
    next->size = impl_->size;
    next->time = impl_->time;
    impl_ = std::move(next);
  }
  impl_->params = params;
  impl_->tracks.keep(FaceWindows::of(params));
  impl_->searched.reset();
}

std::vector<Face> FaceDetector::detect(const cv::Mat& image, const std::string& encoding)
{
  Impl& me = *impl_;
  me.prepare(image, encoding);
  std::vector<Face> faces;
  for (const FoundFace& found : me.near.find(me.gray, cv::Rect({0, 0}, me.gray.size()), FaceWindows::of(me.params)))
    faces.push_back({-1, found.box, scoreOf(found.neighbors), {}, false});
  return faces;
}

std::vector<Face> FaceDetector::update(double time_s, const cv::Mat& image, const std::string& encoding)
{
  requireFinite("time_s", time_s);
  Impl& me = *impl_;
  const cv::Mat plain = me.prepare(image, encoding);
  if (me.gray.size() != me.size || time_s < me.time) me.forget();
  me.size = me.gray.size();
  me.searching += std::min(time_s - me.time, kLongestFrame);
  me.time = time_s;
  me.moving.update(plain);  // equalised, all of it changes when something bright comes in
  me.takeResult();
  me.tracks.follow(time_s, me.gray, me.near, me.params);
  me.search();
  return me.tracks.faces();
}

std::vector<cv::Rect> FaceDetector::findEyes(const Face& face)
{
  Impl& me = *impl_;
  const cv::Rect box = face.box & cv::Rect({0, 0}, me.gray.size());
  if (me.eyes.empty() || box.empty()) return {};
  const cv::Rect upper(box.x, box.y, box.width, std::max(box.height * 3 / 5, 1));
  const double scale = static_cast<double>(kEyeFace) / upper.width;
  cv::Mat pixels;
  cv::resize(me.gray(upper), pixels, {kEyeFace, cvCeil(upper.height * scale)});
  std::vector<cv::Rect> found;
  std::vector<int> neighbors;
  me.eyes.detectMultiScale(pixels, found, neighbors, 1.1, kEyeNeighbors, 0, {kEyeFace / 8, kEyeFace / 8},
                           {kEyeFace * 2 / 5, kEyeFace * 2 / 5});
  // The surest in each half.
  std::vector<cv::Rect> eyes;
  for (const bool left : {true, false})
  {
    int best = -1;
    for (int i = 0; i < static_cast<int>(found.size()); ++i)
      if ((2 * found[i].x + found[i].width < kEyeFace) == left && (best < 0 || neighbors[i] > neighbors[best]))
        best = i;
    if (best < 0) continue;
    const cv::Rect& eye = found[best];
    eyes.emplace_back(upper.x + cvRound(eye.x / scale), upper.y + cvRound(eye.y / scale), cvRound(eye.width / scale),
                      cvRound(eye.height / scale));
  }
  return eyes;
}

double FaceDetector::searchTime() const
{
  return impl_->search_time;
}

void FaceDetector::waitForSearch() const
{
  impl_->worker->wait();
}

}  // namespace robot_vision
