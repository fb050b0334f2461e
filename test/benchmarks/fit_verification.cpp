// Fits the weights by which PoseVerifier makes probabilities of evidence (verification_weights.hpp) to seeded scenes:
// with each sample mesh among all others, hidden or not, or not there at all, and with each kind of frame. Poses are
// what a matcher's candidates become when they are refined, and poses near the truth. Prints the table, and how well
// it tells right poses from wrong ones in scenes that it was not fitted to.

#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <limits>
#include <map>
#include <stdexcept>

#include "core/recognition/verification_weights.hpp"
#include "recognition_trials.hpp"
#include "robot_vision/recognition/object_matcher.hpp"
#include "robot_vision/recognition/object_recognizer.hpp"
#include "robot_vision/recognition/pose_refiner.hpp"
#include "robot_vision/recognition/pose_verifier.hpp"
#include "robot_vision/recognition/view_trainer.hpp"

using namespace robot_vision;

namespace
{

constexpr std::size_t kWeights = std::tuple_size<VerificationWeights>::value;
constexpr double kRight = 0.85, kWrong = 0.6;           // likeness of what is seen in poses that are right, and wrong
constexpr double kDepthGate = 0.02, kColorGate = 0.15;  // of the diameter: differences of depth that are alike, where
                                                        // depths are measured and where they are not
constexpr int kCandidates = 6;                          // of a frame, that are refined
constexpr int kSunken = 2;                              // poses in the table, whose depth and texture one side can have
constexpr double kRidge = 0.5;                          // how much weights are held back, in examples

struct Example
{
  std::vector<double> features;
  bool is_right;
};

struct Kind
{
  const char* name;
  bool colors, depths;  // of the frame
  bool painted;         // whether the model has the object's colors
};
constexpr std::array<Kind, 4> kKinds = {{{"kColorAndDepthWeights", true, true, true},
                                         {"kShapeWeights", true, true, false},
                                         {"kDepthWeights", false, true, false},
                                         {"kColorWeights", true, false, true}}};
using Examples = std::array<std::vector<Example>, kKinds.size()>;  // of each kind of frames and models
using Choice = std::array<bool, kKinds.size()>;                    // of kinds

Mesh withoutColors(Mesh mesh)
{
  mesh.colors.clear();
  mesh.texture_coordinates.clear();
  mesh.textures.clear();
  mesh.triangle_textures.clear();
  mesh.color = Mesh().color;
  return mesh;
}

/// Adds what the verifier sees of poses in frames.
class Collector
{
public:
  Collector(const trials::Object& object, const Choice& is_wanted) : object_(object), is_wanted_(is_wanted)
  {
    for (const DepthSensor sensor : {DepthSensor::kKinect, DepthSensor::kStereo})
      judges_.try_emplace(sensor, sensor);
    matcher_.add(trainViews(object.mesh, ViewParams(), object.symmetries));
    const Mesh plain = withoutColors(object.mesh);
    plain_matcher_.add(trainViews(plain, ViewParams(), object.symmetries));
    plain_shape_ = std::make_shared<ObjectShape>(plain, object.symmetries);
  }

  void look(const ClutteredFrame& seen, DepthSensor sensor, bool is_there, cv::RNG& random, Examples& examples)
  {
    std::vector<Pose> chosen;
    for (const double error : {0.01, 0.02, 0.06})  // of the diameter
      if (is_there && seen.visible > 0.3) chosen.push_back({disturb(seen.pose, error, random)});
    for (const double share : {0.9, 1.12})  // of the distance: what is larger or smaller, and else alike
      if (is_there && seen.visible > 0.3) chosen.push_back({{seen.pose.rotation(), share * seen.pose.translation()}});
    for (int i = 0; i < kSunken; ++i)
      chosen.push_back({sunken(seen.table, random), true});
    for (std::size_t i = 0; i < kKinds.size(); ++i)
    {
      const bool painted = kKinds[i].painted;
      if (!is_wanted_[i] || (painted && !object_.shape->hasColors())) continue;
      const cv::Mat bgr = kKinds[i].colors ? seen.bgr : cv::Mat(), depth = kKinds[i].depths ? seen.depth : cv::Mat();
      RecognitionFrame frame(seen.camera);
      frame.set(bgr, depth);
      std::vector<Pose> poses = chosen;
      ObjectMatcher& matcher = painted ? matcher_ : plain_matcher_;
      for (const PoseCandidate& candidate : matcher.match(bgr, depth, "32FC1", seen.camera))
        if (poses.size() < chosen.size() + kCandidates) poses.push_back({candidate.pose});
      const Looked looked{frame, judges_.at(sensor), kKinds[i], seen, is_there};
      for (const Pose& pose : poses)
        add(looked, pose, examples[i]);
    }
  }

private:
  struct Pose
  {
    cv::Affine3d first;
    bool is_sunken = false;  // in the table
  };

  /// What refines and verifies poses in frames of a sensor.
  struct Judge
  {
    explicit Judge(DepthSensor sensor)
      : refiner(RefinerParams(), trials::errorsOf(sensor)), verifier(VerifierParams(), trials::errorsOf(sensor))
    {
    }

    PoseRefiner refiner;
    PoseVerifier verifier;
  };

  /// What a frame of a kind shows.
  struct Looked
  {
    const RecognitionFrame& frame;
    Judge& judge;
    const Kind& kind;
    const ClutteredFrame& seen;
    bool is_there;
  };

  cv::Affine3d disturb(const cv::Affine3d& pose, double error, cv::RNG& random) const
  {
    cv::Vec3d shift, turn;
    for (int i = 0; i < 3; ++i)
    {
      shift[i] = random.gaussian(error * object_.shape->extent().diameter);
      turn[i] = random.gaussian(2.0 * error);
    }
    const cv::Vec3d center = object_.shape->extent().center;
    const cv::Matx33d rotation = cv::Affine3d(turn).rotation() * pose.rotation();
    return {rotation, pose * center + shift - rotation * center};
  }

  /// A pose in which the object is in the table but for its upper side, which is in its surface.
  cv::Affine3d sunken(const cv::Affine3d& table, cv::RNG& random) const
  {
    const MeshExtent& extent = object_.shape->extent();
    const int up = random.uniform(0, 3);
    cv::Matx33d rotation = cv::Matx33d::zeros();
    for (int i = 0; i < 3; ++i)
      rotation(i, (up + 1 + i) % 3) = 1.0;
    if (random.uniform(0, 2) == 1) rotation = cv::Matx33d(1, 0, 0, 0, -1, 0, 0, 0, -1) * rotation;
    rotation = cv::Affine3d(cv::Vec3d(0.0, 0.0, random.uniform(0.0, 2.0 * CV_PI))).rotation() * rotation;
    const cv::Vec3d middle(random.uniform(-0.3, 0.3), random.uniform(-0.2, 0.3), -0.5 * extent.size[up]);
    return table * cv::Affine3d(rotation, middle - rotation * extent.center);
  }

  void add(const Looked& looked, const Pose& tried, std::vector<Example>& examples)
  {
    const auto& [frame, judge, kind, seen, is_there] = looked;
    const ObjectShape& shape = kind.painted ? *object_.shape : *plain_shape_;
    const cv::Affine3d pose = judge.refiner.refine(frame, shape, tried.first).pose;
    PoseEvidence evidence = judge.verifier.verify(frame, shape, pose).evidence;
    if (evidence.pixels == 0.0) return;
    if (tried.is_sunken && kind.painted && kind.depths)
    {
      evidence.colors = 1.0;  // a table may have the object's color
      evidence.pattern = std::numeric_limits<double>::quiet_NaN();
    }
    const double gate = (kind.depths ? kDepthGate : kColorGate) * object_.shape->extent().diameter;
    const bool colors = kind.painted && kind.colors;
    const double alike =
        is_there ? trials::likeness(object_, pose, seen.pose, seen.camera.K, frame.size(), gate, colors) : 0.0;
    if (alike > kWrong && alike < kRight) return;
    examples.push_back({evidenceFeatures(evidence), alike >= kRight});
  }

  const trials::Object& object_;
  const Choice is_wanted_;
  ObjectMatcher matcher_, plain_matcher_;
  std::shared_ptr<const ObjectShape> plain_shape_;
  std::map<DepthSensor, Judge> judges_;
};

/// Cameras have other colors than meshes: brighter or darker, of another light, and not as sharp.
void disturb(cv::Mat& bgr, cv::RNG& random)
{
  const double brightness = random.uniform(0.6, 1.3);
  cv::Scalar gains;
  for (int i = 0; i < 3; ++i)
    gains[i] = brightness * random.uniform(0.87, 1.15);
  cv::multiply(bgr, gains, bgr);
  cv::GaussianBlur(bgr, bgr, {5, 5}, random.uniform(0.2, 1.0));
}

Examples collect(int frames, std::uint64_t seed, const Choice& is_wanted)
{
  Examples examples;
  cv::RNG random(seed);
  for (const trials::Object& object : trials::objectsOf(trials::samples(), seed))
  {
    Collector collector(object, is_wanted);
    for (int i = 0; i < frames; ++i)
    {
      ClutterParams params;
      params.with_object = i % 3 != 2;
      params.occlusion = std::array<double, 4>{0.0, 0.2, 0.4, 0.6}[static_cast<std::size_t>(i) / 3 % 4];
      params.sensor = i % 2 == 0 ? DepthSensor::kKinect : DepthSensor::kStereo;
      ClutteredFrame frame = object.scenes->frame(i, params);
      disturb(frame.bgr, random);
      // Some users do not say that their sensor is no Kinect.
      const DepthSensor said = i % 4 == 3 ? DepthSensor::kKinect : params.sensor;
      collector.look(frame, said, params.with_object, random, examples);
    }
    std::fprintf(stderr, "%s: %zu poses\n", object.name.c_str(),
                 std::max({examples[0].size(), examples[1].size(), examples[2].size()}));
  }
  return examples;
}

double probabilityOf(const Example& example, const cv::Mat_<double>& weights)
{
  double sum = weights(0);
  for (std::size_t i = 0; i < example.features.size(); ++i)
    sum += weights(static_cast<int>(i) + 1) * example.features[i];
  return 1.0 / (1.0 + std::exp(-sum));
}

/// Logistic regression by Newton's method.
cv::Mat_<double> fit(const std::vector<Example>& examples)
{
  const int count = static_cast<int>(kWeights);
  cv::Mat_<double> weights = cv::Mat_<double>::zeros(count, 1);
  for (int step = 0; step < 30; ++step)
  {
    cv::Mat_<double> hessian = cv::Mat_<double>::eye(count, count) * kRidge, gradient = weights * -kRidge;
    for (const Example& example : examples)
    {
      cv::Mat_<double> row(count, 1);
      row(0) = 1.0;
      for (int i = 1; i < count; ++i)
        row(i) = example.features[static_cast<std::size_t>(i) - 1];
      const double p = probabilityOf(example, weights);
      hessian += row * row.t() * (p * (1.0 - p));
      gradient += row * ((example.is_right ? 1.0 : 0.0) - p);
    }
    cv::Mat_<double> by;
    cv::solve(hessian, gradient, by, cv::DECOMP_CHOLESKY);
    weights += by;
  }
  return weights;
}

void tell(const std::vector<Example>& examples, const cv::Mat_<double>& weights)
{
  for (const double threshold : {0.3, 0.5, RecognizerParams().threshold, 0.7, 0.9})
  {
    int right = 0, accepted = 0, wrong = 0, false_ones = 0;
    for (const Example& example : examples)
    {
      const bool is_accepted = probabilityOf(example, weights) >= threshold;
      (example.is_right ? right : wrong) += 1;
      (example.is_right ? accepted : false_ones) += is_accepted ? 1 : 0;
    }
    std::fprintf(stderr, "  from %.1f on: %d of %d right ones, %d of %d wrong ones\n", threshold, accepted, right,
                 false_ones, wrong);
  }
  for (int decile = 0; decile < 10; ++decile)  // whether the probabilities are what they say
  {
    int all = 0, right = 0;
    for (const Example& example : examples)
      if (static_cast<int>(probabilityOf(example, weights) * 9.999) == decile)
      {
        ++all;
        right += example.is_right ? 1 : 0;
      }
    std::fprintf(stderr, "  %.1f to %.1f: %d of %d are right\n", decile / 10.0, decile / 10.0 + 0.1, right, all);
  }
}

}  // namespace

int main(int argc, char** argv)
try
{
  if (argc < 2)
    throw std::invalid_argument("fit_verification FRAMES (of each object and kind) [names of the weights to fit]");
  const int frames = std::max(std::atoi(argv[1]), 12);
  cv::setNumThreads(1);
  Choice is_wanted;
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind)
    is_wanted[kind] = argc == 2 || std::count(argv + 2, argv + argc, std::string(kKinds[kind].name)) > 0;
  const Examples seen = collect(frames, 1, is_wanted), others = collect(frames / 3, 2, is_wanted);
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind)
  {
    if (!is_wanted[kind]) continue;
    const cv::Mat_<double> weights = fit(seen[kind]);
    std::printf("constexpr VerificationWeights %s = {", kKinds[kind].name);
    for (int i = 0; i < weights.rows; ++i)
      std::printf("%s%.2f", i > 0 ? ", " : "", weights(i));
    std::printf("};\n");
    std::fflush(stdout);
    tell(others[kind], weights);
  }
  return 0;
}
catch (const std::exception& e)
{
  std::fprintf(stderr, "fit_verification: %s\n", e.what());
  return 1;
}
