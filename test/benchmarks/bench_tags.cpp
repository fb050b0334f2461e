// AprilTags, ours and with a plain call of libapriltag for each frame: bench_tags IMAGE WIDTH HEIGHT TAGS ROUNDS
//
// Tags of tag36h11 move before a photograph that moves, too, with pixel noise, at 30 Hz. Both see the same mono8
// frames, in turns of some seconds and as they come from a camera: the library in full resolution with 2 threads, as
// apriltag_ros uses it; ours as the node does, with its searches in the background: with corners as they are found, and
// with corners that are measured then, which is the node's default. Prints JSON: how many tags there are in a frame,
// and for each the CPU time (mean, of all threads) and the latency (median, 99 % and worst) of one in ms, the tags
// found in all, the longest time in s that one was not, and how far from the truth the corners are (median) in px. Then
// what it takes to measure the corners of a tag where ours found it: CPU time (median) in ms, and how far they are
// then.

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <thread>

#include "measure.hpp"
#include "robot_vision/tags/detection/tag_detector.hpp"
#include "robot_vision/tags/pose/corner_refinement.hpp"
#include "robot_vision/tags/pose/corner_undistortion.hpp"
#include "support/tag_images.hpp"

namespace
{

constexpr const char* kFamily = "tag36h11";
constexpr int kFrames = 45;
constexpr double kStep = 1.0 / 30.0;  // s
constexpr double kRest = 0.5;         // s after a turn, in which a search in the background ends

struct Frame
{
  cv::Mat gray;
  std::vector<TagCorners> truth;  // by id
};

/// Each tag goes round in a field of its own.
TagCorners cornersAt(int id, int tags, int frame, cv::Size size)
{
  const int columns = cvCeil(std::sqrt(tags * size.width / static_cast<double>(size.height)));
  const int rows = cvCeil(tags / static_cast<double>(columns));
  const cv::Point2d field(size.width / static_cast<double>(columns), size.height / static_cast<double>(rows));
  const double side = 0.45 * std::min({field.x, field.y, size.height / 4.0});
  const double phase = 2.0 * CV_PI * (frame * kStep / 3.0 + id * 0.37);
  const cv::Point2d middle((id % columns + 0.5) * field.x, (id / columns + 0.5) * field.y);
  const cv::Point2d way(std::cos(phase) * field.x * 0.1, std::sin(phase) * field.y * 0.1);
  return tagCorners(middle + way, side, 0.4 * std::sin(phase), 0.6, phase);
}

std::vector<Frame> makeFrames(const char* image, cv::Size size, int tags)
{
  const std::vector<cv::Mat> behind = bench::movingImage(image, size);
  cv::RNG random(1);
  std::vector<Frame> frames(kFrames);
  for (int i = 0; i < kFrames; ++i)
  {
    Frame& frame = frames[static_cast<std::size_t>(i)];
    const int there_and_back = std::abs(i % 14 - 7);
    cv::cvtColor(behind[static_cast<std::size_t>(there_and_back)], frame.gray, cv::COLOR_BGR2GRAY);
    for (int id = 0; id < tags; ++id)
    {
      frame.truth.push_back(cornersAt(id, tags, i, size));
      drawTag(frame.gray, kFamily, id, frame.truth.back());
    }
    cv::GaussianBlur(frame.gray, frame.gray, {0, 0}, 0.7);
    addNoise(frame.gray, 2.0, random);
  }
  return frames;
}

class Plain
{
public:
  Plain()
  {
    detector_->nthreads = 2;
    detector_->quad_decimate = 1.0F;
    apriltag_detector_add_family(detector_.get(), family_.get());
  }

  std::map<int, TagCorners> find(const cv::Mat& gray, double /*time_s*/)
  {
    image_u8_t image = {gray.cols, gray.rows, static_cast<int>(gray.step), gray.data};
    const std::unique_ptr<zarray_t, void (*)(zarray_t*)> found(apriltag_detector_detect(detector_.get(), &image),
                                                               apriltag_detections_destroy);
    std::map<int, TagCorners> corners;
    for (int i = 0; i < zarray_size(found.get()); ++i)
    {
      apriltag_detection_t* tag = nullptr;
      zarray_get(found.get(), i, &tag);
      for (std::size_t k = 0; k < 4; ++k)
        corners[tag->id][k] = cv::Point2d(tag->p[k][0] - 0.5, tag->p[k][1] - 0.5);
    }
    return corners;
  }

private:
  std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)> family_{tag36h11_create(), tag36h11_destroy};
  std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector_{apriltag_detector_create(),
                                                                                 apriltag_detector_destroy};
};

robot_vision::CameraModel cameraOf(cv::Size size)
{
  const double f = size.width, x = size.width / 2.0, y = size.height / 2.0;
  return {size.width, size.height, {f, 0.0, x, 0.0, f, y, 0.0, 0.0, 1.0}, {}};
}

class Ours
{
public:
  explicit Ours(bool measures) : measures_(measures) {}

  std::map<int, TagCorners> find(const cv::Mat& gray, double time_s)
  {
    std::map<int, TagCorners> corners;
    for (const robot_vision::Tag& tag : detector_.update(time_s, gray, "mono8"))
    {
      corners[tag.id] = tag.corners;
      if (const auto measured = measures_ ? measure(gray, tag) : std::nullopt) corners[tag.id] = measured->corners;
    }
    return corners;
  }

private:
  std::optional<robot_vision::TagCorners> measure(const cv::Mat& gray, const robot_vision::Tag& tag)
  {
    cv::Mat& cells = cells_[tag.id];
    if (cells.empty()) cells = robot_vision::tagCells(kFamily, tag.id);
    const robot_vision::CameraModel camera = cameraOf(gray.size());
    const int width = robot_vision::tagFamily(kFamily).width_at_border;
    const robot_vision::TagCorners found{tag.id, robot_vision::withoutBentEdges(tag.corners, camera), std::nullopt};
    return robot_vision::measureCorners(gray, cells, width, found, camera);
  }

  static robot_vision::TagDetectorParams params()
  {
    robot_vision::TagDetectorParams params;
    params.background = true;
    return params;
  }

  robot_vision::TagDetector detector_{params()};
  bool measures_;
  std::map<int, cv::Mat> cells_;  // by id
};

class Contender
{
public:
  using Find = std::function<std::map<int, TagCorners>(const cv::Mat&, double)>;

  /// The first frame is not counted: all of it is searched in any case.
  Contender(Find find, const Frame& first) : find_(std::move(find)) { find_(first.gray, -kStep); }

  /// All frames, each when it is due or, late, at once.
  void see(const std::vector<Frame>& frames)
  {
    const double cpu = bench::seconds(CLOCK_PROCESS_CPUTIME_ID);
    const auto begin = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < frames.size(); ++i)
    {
      std::this_thread::sleep_until(begin + std::chrono::duration<double>(static_cast<double>(i) * kStep));
      see(frames[i], static_cast<double>(latencies_.size()) * kStep);
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(kRest));
    cpu_ += (bench::seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu) * 1e3;
  }

  void print() const
  {
    std::vector<double> sorted = latencies_;
    std::sort(sorted.begin(), sorted.end());
    std::printf("{\"cpu\": %.4f, \"median\": %.4f, \"p99\": %.4f, \"worst\": %.4f, ",
                cpu_ / static_cast<double>(sorted.size()), sorted[sorted.size() / 2], sorted[sorted.size() * 99 / 100],
                sorted.back());
    std::printf("\"found\": %d, \"longest\": %.4f, \"error\": %.4f}", found_, longest_,
                errors_.empty() ? 0.0 : bench::median(errors_));
  }

private:
  void see(const Frame& frame, double time_s)
  {
    const double begin = bench::seconds(CLOCK_MONOTONIC);
    const std::map<int, TagCorners> found = find_(frame.gray, time_s);
    latencies_.push_back((bench::seconds(CLOCK_MONOTONIC) - begin) * 1e3);
    last_seen_.resize(frame.truth.size(), time_s - kStep);
    for (std::size_t id = 0; id < frame.truth.size(); ++id)
    {
      const auto tag = found.find(static_cast<int>(id));
      if (tag != found.end() && cv::norm(tag->second[0] - frame.truth[id][0]) < 5.0)
      {
        ++found_;
        last_seen_[id] = time_s;
        for (std::size_t i = 0; i < 4; ++i)
          errors_.push_back(cv::norm(tag->second[i] - frame.truth[id][i]));
      }
      longest_ = std::max(longest_, time_s - last_seen_[id]);
    }
  }

  Find find_;
  double cpu_ = 0.0;  // ms
  std::vector<double> latencies_, errors_;
  int found_ = 0;
  std::vector<double> last_seen_;  // s, by id
  double longest_ = 0.0;           // s
};

void measureTags(const std::vector<Frame>& frames)
{
  const robot_vision::TagFamily& family = robot_vision::tagFamily(kFamily);
  const robot_vision::CameraModel camera = cameraOf(frames.front().gray.size());
  robot_vision::TagDetector detector;
  std::vector<double> times, errors;
  for (const Frame& frame : frames)
    for (const robot_vision::Tag& tag : detector.detect(frame.gray, "mono8"))
    {
      const cv::Mat cells = robot_vision::tagCells(kFamily, tag.id);
      const double begin = bench::seconds(CLOCK_PROCESS_CPUTIME_ID);
      const auto measured =
          robot_vision::measureCorners(frame.gray, cells, family.width_at_border, {tag.id, tag.corners}, camera);
      times.push_back((bench::seconds(CLOCK_PROCESS_CPUTIME_ID) - begin) * 1e3);
      for (std::size_t i = 0; measured && i < 4; ++i)
        errors.push_back(cv::norm(measured->corners[i] - frame.truth[static_cast<std::size_t>(tag.id)][i]));
    }
  std::printf("{\"cpu\": %.4f, \"error\": %.4f}", times.empty() ? 0.0 : bench::median(times),
              errors.empty() ? 0.0 : bench::median(errors));
}

}  // namespace

int main(int argc, char** argv)
try
{
  if (argc != 6) throw std::invalid_argument("bench_tags IMAGE WIDTH HEIGHT TAGS ROUNDS");
  cv::setNumThreads(1);
  const std::vector<Frame> frames = makeFrames(argv[1], {std::atoi(argv[2]), std::atoi(argv[3])}, std::atoi(argv[4]));
  Plain plain;
  Ours ours(false), measuring(true);
  Contender theirs([&plain](const cv::Mat& gray, double time_s) { return plain.find(gray, time_s); }, frames.front());
  Contender mine([&ours](const cv::Mat& gray, double time_s) { return ours.find(gray, time_s); }, frames.front());
  Contender precise([&measuring](const cv::Mat& gray, double time_s) { return measuring.find(gray, time_s); },
                    frames.front());
  for (int round = 0; round < std::max(std::atoi(argv[5]), 1); ++round)
    for (Contender* contender : {&theirs, &mine, &precise})
      contender->see(frames);
  std::printf("{\"tags\": %d, \"plain\": ", std::atoi(argv[4]));
  theirs.print();
  std::printf(", \"ours\": ");
  mine.print();
  std::printf(", \"measuring\": ");
  precise.print();
  std::printf(", \"corners\": ");
  measureTags(frames);
  std::printf("}\n");
  return 0;
}
catch (const std::exception& e)
{
  std::fprintf(stderr, "bench_tags: %s\n", e.what());
  return 1;
}
