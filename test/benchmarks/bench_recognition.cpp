// Measures how many objects are found in cluttered scenes, and how exactly, by the views of a matcher and by pairs of
// points, both with what refines and verifies poses; and by cv::ppf_match_3d and cv::linemod, where these are
// installed. All see the same frames. Prints JSON.

#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "measure.hpp"
#include "recognition_trials.hpp"
#include "robot_vision/recognition/object_matcher.hpp"
#include "robot_vision/recognition/object_recognizer.hpp"
#include "robot_vision/recognition/point_pairs.hpp"
#include "robot_vision/recognition/view_trainer.hpp"
#include "robot_vision/recognition/view_tree.hpp"
#ifdef WITH_SURFACE_MATCHING
#include <opencv2/surface_matching.hpp>

#include "opencv_clouds.hpp"
#endif
#ifdef WITH_LINEMOD
#include "linemod_contender.hpp"
#endif

using namespace robot_vision;

namespace
{

constexpr double kFound = 0.1;  // of the diameter: mean distance (ADD or ADD-S) of an object that was found
constexpr double kTau = 0.05;   // of the diameter: distance of surfaces that are not alike
constexpr double kAlike = 0.1;  // visible discrepancy of a pose that looks like the true one
constexpr std::array<double, 4> kOcclusions = {0.0, 0.2, 0.4, 0.6};

double now()
{
  return bench::seconds(CLOCK_THREAD_CPUTIME_ID);
}

/// Objects that something has found in a frame.
struct Answer
{
  std::vector<cv::Affine3d> poses;
  double match = 0.0, decide = 0.0;  // s
};

bool looksTrue(const trials::Object& object, const ClutteredFrame& frame, const cv::Affine3d& pose)
{
  const double tau = kTau * object.shape->extent().diameter;
  return trials::visibleDiscrepancy(object, pose, frame.pose, frame.camera.K, frame.exact_depth, tau) < kAlike;
}

/// What a contender made of all frames of an object.
class Score
{
public:
  void see(const trials::Object& object, const ClutteredFrame& frame, const ClutterParams& params, const Answer& answer)
  {
    match_.push_back(answer.match * 1e3);
    decide_.push_back(answer.decide * 1e3);
    bool is_found = false, is_alike = false;
    const double near = kFound * object.shape->extent().diameter;
    for (const cv::Affine3d& pose : answer.poses)
    {
      const bool is_right = params.with_object && trials::meanDistance(object, pose, frame.pose) < near;
      is_alike = is_alike || is_right || (params.with_object && looksTrue(object, frame, pose));
      if (!is_right)
      {
        ++wrong_;
        false_ += params.with_object ? 0 : 1;
        continue;
      }
      is_found = true;
      const cv::Vec2d error = trials::visibleError(object, pose, frame.pose);
      shifts_.push_back(error[0] * 1e3);
      turns_.push_back(error[1] * 180.0 / CV_PI);
    }
    if (!params.with_object)
    {
      ++without_;
      return;
    }
    const auto which = static_cast<std::size_t>(std::find(kOcclusions.begin(), kOcclusions.end(), params.occlusion) -
                                                kOcclusions.begin());
    ++frames_[which];
    found_[which] += is_found ? 1 : 0;
    alike_[which] += is_alike ? 1 : 0;
  }

  void print(const std::string& name) const
  {
    std::printf("\"%s\": {\"recall\": [", name.c_str());
    printShares(found_);
    std::printf("], \"recall_as_seen\": [");
    printShares(alike_);
    const int all = static_cast<int>(match_.size());
    std::printf(
        "], \"wrong\": %.4f, \"false\": %.4f, \"mm\": %.3f, \"deg\": %.3f, \"match_ms\": %.2f, \"decide_ms\": %.2f}",
        static_cast<double>(wrong_) / std::max(all, 1), static_cast<double>(false_) / std::max(without_, 1),
        shifts_.empty() ? -1.0 : bench::median(shifts_), turns_.empty() ? -1.0 : bench::median(turns_),
        bench::median(match_), bench::median(decide_));
  }

private:
  using Counts = std::array<int, kOcclusions.size()>;

  void printShares(const Counts& counts) const
  {
    for (std::size_t i = 0; i < frames_.size(); ++i)
      std::printf("%s%.3f", i > 0 ? ", " : "", frames_[i] > 0 ? static_cast<double>(counts[i]) / frames_[i] : -1.0);
  }

  Counts frames_{}, found_{}, alike_{};  // alike: found, or in a pose that looks the same
  int wrong_ = 0, false_ = 0, without_ = 0;
  std::vector<double> shifts_, turns_, match_, decide_;
};

/// A way to find an object: `train` makes it.
struct Contender
{
  std::string name;
  std::function<Answer(const ClutteredFrame&, DepthSensor)> find;
  double train = 0.0;  // s
  Score score;
};

/// Matches, and has the recognizer decide.
template <class Match>
std::function<Answer(const ClutteredFrame&, DepthSensor)> decided(const trials::Object& object, Match match,
                                                                  bool colors, bool depths)
{
  std::map<DepthSensor, std::shared_ptr<ObjectRecognizer>> recognizers;
  for (const DepthSensor sensor : {DepthSensor::kKinect, DepthSensor::kStereo})
  {
    recognizers[sensor] = std::make_shared<ObjectRecognizer>(RecognizerParams(), RefinerParams(), VerifierParams(),
                                                             trials::errorsOf(sensor));
    recognizers[sensor]->add(object.shape);
  }
  return [=](const ClutteredFrame& seen, DepthSensor sensor)
  {
    RecognitionFrame frame(seen.camera);
    Answer answer;
    const double begin = now();
    const std::vector<PoseCandidate> candidates = match(seen, frame);
    const double matched = now();
    frame.set(colors ? seen.bgr : cv::Mat(), depths ? seen.depth : cv::Mat());
    for (const RecognizedObject& found : recognizers.at(sensor)->recognize(frame, candidates).objects)
      answer.poses.push_back(found.pose);
    answer.match = matched - begin;
    answer.decide = now() - matched;
    return answer;
  };
}

Contender views(const trials::Object& object, const char* name, bool colors, bool depths)
{
  Contender contender;
  contender.name = name;
  const double begin = now();
  const ViewModel model = trainViews(object.mesh, ViewParams(), object.symmetries);
  contender.train = now() - begin;
  auto matcher = std::make_shared<ObjectMatcher>();
  matcher->add(model);
  const auto match = [=](const ClutteredFrame& seen, RecognitionFrame&)
  { return matcher->match(colors ? seen.bgr : cv::Mat(), depths ? seen.depth : cv::Mat(), "32FC1", seen.camera); };
  contender.find = decided(object, match, colors, depths);
  return contender;
}

Contender pairs(const trials::Object& object)
{
  Contender contender;
  contender.name = "point pairs";
  const double begin = now();
  auto matcher = std::make_shared<PointPairMatcher>();
  matcher->add(trainPointPairs(object.mesh));
  contender.train = now() - begin;
  const auto match = [=](const ClutteredFrame& seen, RecognitionFrame& frame)
  {
    frame.set(cv::Mat(), seen.depth);
    return matcher->match(frame);
  };
  contender.find = decided(object, match, true, true);
  return contender;
}

#ifdef WITH_SURFACE_MATCHING
constexpr double kFarthest = 1.6;  // m, of what cv::ppf_match_3d is given: no object is farther away
constexpr double kSpacing = 0.05;  // of the diameter, between its points

Contender opencvPairs(const trials::Object& object)
{
  Contender contender;
  contender.name = "cv::ppf_match_3d";
  PointPairParams dense;
  dense.sampling = 0.04;
  const PointPairModel sampled = trainPointPairs(object.mesh, dense);
  cv::Mat model(0, 6, CV_32FC1);
  for (std::size_t i = 0; i < sampled.points.size(); ++i)
  {
    const float row[] = {sampled.points[i][0],  sampled.points[i][1],  sampled.points[i][2],
                         sampled.normals[i][0], sampled.normals[i][1], sampled.normals[i][2]};
    model.push_back(cv::Mat(1, 6, CV_32FC1, const_cast<float*>(row)));
  }
  const double begin = now();
  auto detector = std::make_shared<cv::ppf_match_3d::PPF3DDetector>(kSpacing, kSpacing, 30);
  detector->trainModel(model);
  contender.train = now() - begin;
  const double diameter = object.shape->extent().diameter;
  contender.find = [=](const ClutteredFrame& seen, DepthSensor /*sensor*/)
  {
    Answer answer;
    const double start = now();
    // Pairs of points of planes outvote those of any object: it gets what is left when the truth has removed them.
    cv::Mat near = seen.depth.clone();
    near.setTo(std::nanf(""), (near > kFarthest) | (seen.ids <= 1));
    const cv::Mat cloud = bench::cloudOf(near, seen.camera, 2);
    std::vector<cv::ppf_match_3d::Pose3DPtr> results;
    // Its distance is a share of the scene's extent, and is to be that of the model's points.
    double extent = 0.0;
    for (int i = 0; i < 3; ++i)
    {
      double low = 0.0, high = 0.0;
      cv::minMaxLoc(cloud.col(i), &low, &high);
      extent = std::max(extent, high - low);
    }
    detector->match(cloud, results, 1.0 / 5.0, kSpacing * diameter / extent);
    answer.match = now() - start;
    results.resize(std::min<std::size_t>(results.size(), 5));
    if (!results.empty()) cv::ppf_match_3d::ICP(100, 0.005F, 2.5F, 8).registerModelToScene(model, cloud, results);
    answer.decide = now() - start - answer.match;
    const auto best = std::min_element(results.begin(), results.end(),
                                       [](const auto& a, const auto& b) { return a->residual < b->residual; });
    if (best != results.end()) answer.poses.emplace_back((*best)->pose);
    return answer;
  };
  return contender;
}
#endif

#ifdef WITH_LINEMOD
Contender opencvLinemod(const trials::Object& object)
{
  Contender contender;
  contender.name = "cv::linemod";
  const double begin = now();
  auto linemod = std::make_shared<const LinemodContender>(object);
  contender.train = now() - begin;
  contender.find = [=](const ClutteredFrame& seen, DepthSensor /*sensor*/)
  {
    Answer answer;
    const double start = now();
    const std::vector<cv::linemod::Match> matches = linemod->match(seen);
    answer.match = now() - start;
    answer.poses = linemod->decide(seen, matches);
    answer.decide = now() - start - answer.match;
    return answer;
  };
  return contender;
}
#endif

/// Those whose names have one of the words in them, which have commas between them; all if there is none.
std::vector<Contender> contendersFor(const trials::Object& object, const std::string& words)
{
  std::vector<Contender> contenders;
  const auto offer = [&](const std::string& name, const auto& make)
  {
    std::istringstream stream(words);
    bool is_chosen = words.empty();
    for (std::string word; std::getline(stream, word, ',');)
      is_chosen = is_chosen || name.find(word) != std::string::npos;
    if (is_chosen) contenders.push_back(make());
  };
  offer("views", [&] { return views(object, "views", true, true); });
  offer("views, depth only", [&] { return views(object, "views, depth only", false, true); });
  offer("views, colors only", [&] { return views(object, "views, colors only", true, false); });
  offer("point pairs", [&] { return pairs(object); });
#ifdef WITH_SURFACE_MATCHING
  offer("cv::ppf_match_3d", [&] { return opencvPairs(object); });
#endif
#ifdef WITH_LINEMOD
  offer("cv::linemod", [&] { return opencvLinemod(object); });
#endif
  return contenders;
}

void measure(const trials::Object& object, int frames, const std::string& words)
{
  std::vector<Contender> contenders = contendersFor(object, words);
  for (int i = 0; i < frames; ++i)
  {
    ClutterParams params;
    params.with_object = i % 3 != 2;
    params.occlusion = kOcclusions[static_cast<std::size_t>(i / 3) % kOcclusions.size()];
    params.sensor = i % 2 == 0 ? DepthSensor::kKinect : DepthSensor::kStereo;
    const ClutteredFrame frame = object.scenes->frame(i, params);
    for (Contender& contender : contenders)
      contender.score.see(object, frame, params, contender.find(frame, params.sensor));
  }
  std::printf("{\"object\": \"%s\"", object.name.c_str());
  for (const Contender& contender : contenders)
  {
    std::printf(",\n  ");
    contender.score.print(contender.name);
    std::printf(", \"train %s\": %.3f", contender.name.c_str(), contender.train);
  }
  std::printf("}");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv)
try
{
  if (argc < 2)
    throw std::invalid_argument(
        "bench_recognition FRAMES [words of the contenders' names, with commas [folder of assimp-testmodels]]");
  cv::setNumThreads(1);
  const std::vector<trials::Thing> things = argc > 3 ? trials::testModels(argv[3]) : trials::samples();
  const char* comma = "[";
  for (const trials::Object& object : trials::objectsOf(things, 3))
  {
    std::printf("%s", comma);
    measure(object, std::max(std::atoi(argv[1]), 3), argc > 2 ? argv[2] : "");
    comma = ",\n";
  }
  std::printf("]\n");
  return 0;
}
catch (const std::exception& e)
{
  std::fprintf(stderr, "bench_recognition: %s\n", e.what());
  return 1;
}
