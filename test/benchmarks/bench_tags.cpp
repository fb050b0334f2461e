// AprilTags, ours and with a plain call of libapriltag for each frame: bench_tags PICTURE WIDTH HEIGHT TAGS ROUNDS
//
// Tags of tag36h11 move before a photograph that moves, too, with pixel noise, at 30 Hz. Both see the same mono8 frames
// in turns: the library in full resolution with 2 threads, as apriltag_ros uses it; ours in one, with its own defaults.
// Prints JSON: how many tags there are in a frame, and for both the CPU time (mean) and the latency (median and worst)
// of one in ms, the tags found in all, the longest time in s that one was not, and how far from the truth the corners
// are (median) in px.

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include <cstdlib>
#include <functional>
#include <map>
#include <memory>

#include "../core/tag_pictures.hpp"
#include "measure.hpp"
#include "robot_vision/tag_detector.hpp"

namespace
{

constexpr const char* kFamily = "tag36h11";
constexpr int kFrames = 45;
constexpr double kStep = 1.0 / 30.0;  // s

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

std::vector<Frame> makeFrames(const char* picture, cv::Size size, int tags)
{
  const std::vector<cv::Mat> behind = bench::movingPicture(picture, size);
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

class Ours
{
public:
  std::map<int, TagCorners> find(const cv::Mat& gray, double time_s)
  {
    std::map<int, TagCorners> corners;
    for (const robot_vision::Tag& tag : detector_.update(time_s, gray, "mono8"))
      corners[tag.id] = tag.corners;
    return corners;
  }

private:
  robot_vision::TagDetector detector_;
};

class Contender
{
public:
  using Find = std::function<std::map<int, TagCorners>(const cv::Mat&, double)>;

  explicit Contender(Find find) : find_(std::move(find)) {}

  void see(const Frame& frame, double time_s)
  {
    const double cpu = bench::seconds(CLOCK_PROCESS_CPUTIME_ID);
    const double begin = bench::seconds(CLOCK_MONOTONIC);
    const std::map<int, TagCorners> found = find_(frame.gray, time_s);
    latencies_.push_back((bench::seconds(CLOCK_MONOTONIC) - begin) * 1e3);
    cpu_ += (bench::seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu) * 1e3;
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

  void print() const
  {
    std::printf("{\"cpu\": %.4f, \"median\": %.4f, \"worst\": %.4f, \"found\": %d, \"longest\": %.4f, \"error\": %.4f}",
                cpu_ / static_cast<double>(latencies_.size()), bench::median(latencies_),
                *std::max_element(latencies_.begin(), latencies_.end()), found_, longest_,
                errors_.empty() ? 0.0 : bench::median(errors_));
  }

private:
  Find find_;
  double cpu_ = 0.0;  // ms
  std::vector<double> latencies_, errors_;
  int found_ = 0;
  std::vector<double> last_seen_;  // s, by id
  double longest_ = 0.0;           // s
};

}  // namespace

int main(int argc, char** argv)
try
{
  if (argc != 6) throw std::invalid_argument("bench_tags PICTURE WIDTH HEIGHT TAGS ROUNDS");
  cv::setNumThreads(1);
  const std::vector<Frame> frames = makeFrames(argv[1], {std::atoi(argv[2]), std::atoi(argv[3])}, std::atoi(argv[4]));
  Plain plain;
  Ours ours;
  Contender theirs([&plain](const cv::Mat& gray, double time_s) { return plain.find(gray, time_s); });
  Contender mine([&ours](const cv::Mat& gray, double time_s) { return ours.find(gray, time_s); });
  int count = 0;
  for (int round = 0; round < std::max(std::atoi(argv[5]), 1); ++round)
    for (const Frame& frame : frames)
    {
      const double time_s = count++ * kStep;
      for (const bool first : {true, false})  // the second finds the picture in the cache
        (first == (count % 2 == 0) ? theirs : mine).see(frame, time_s);
    }
  std::printf("{\"tags\": %d, \"plain\": ", std::atoi(argv[4]));
  theirs.print();
  std::printf(", \"ours\": ");
  mine.print();
  std::printf("}\n");
  return 0;
}
catch (const std::exception& e)
{
  std::fprintf(stderr, "bench_tags: %s\n", e.what());
  return 1;
}
