#include "robot_vision/recognition/object_matcher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "robot_vision/meshes/sample_meshes.hpp"
#include "robot_vision/recognition/view_trainer.hpp"
#include "support/cluttered_scenes.hpp"
#include "support/object_scenes.hpp"
#include "support/refusal.hpp"
#include "support/thread_counts.hpp"

using namespace robot_vision;

namespace
{

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Sample
{
  explicit Sample(const std::string& name) : mesh(sampleMesh(name).mesh)
  {
    for (const SampleSymmetry& symmetry : sampleMesh(name).symmetries)
      symmetries.push_back({symmetry.axis, symmetry.fold});
    model = trainViews(mesh, ViewParams(), symmetries);
  }

  Mesh mesh;
  std::vector<Symmetry> symmetries;
  ViewModel model;
};

const Sample& duck()
{
  static const Sample one("duck");
  return one;
}

const Sample& bottle()
{
  static const Sample one("bottle");
  return one;
}

ClutteredScenes scenesOf(const Sample& sample, const CameraModel& camera = kinectCamera(320))
{
  return ClutteredScenes(sample.mesh, {sampleMesh("mug").mesh, sampleMesh("box").mesh, sampleMesh("nut").mesh}, 11,
                         camera);
}

/// The mean distance (m) of the object's points in both poses: of each from itself or, if it looks the same in several
/// poses, from the nearest one.
double meanDistance(const Sample& sample, const cv::Affine3d& found, const cv::Affine3d& truth)
{
  std::vector<cv::Vec3d> a, b;
  for (std::size_t i = 0; i < sample.mesh.vertices.size();
       i += std::max<std::size_t>(1, sample.mesh.vertices.size() / 150))
  {
    a.push_back(found * cv::Vec3d(sample.mesh.vertices[i]));
    b.push_back(truth * cv::Vec3d(sample.mesh.vertices[i]));
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    double nearest = cv::norm(a[i] - b[i]);
    for (std::size_t j = 0; j < b.size() && !sample.symmetries.empty(); ++j)
      nearest = std::min(nearest, cv::norm(a[i] - b[j]));
    sum += nearest;
  }
  return sum / static_cast<double>(a.size());
}

bool hasPose(const Sample& sample, const std::vector<PoseCandidate>& candidates, const cv::Affine3d& truth)
{
  return std::any_of(candidates.begin(), candidates.end(),
                     [&](const PoseCandidate& one)
                     { return meanDistance(sample, one.pose, truth) < 0.1 * sample.model.extent.diameter; });
}

enum class Sees
{
  kBoth,
  kDepth,
  kColors
};

std::vector<PoseCandidate> matchIn(ObjectMatcher& matcher, const ClutteredFrame& frame, Sees sees = Sees::kBoth)
{
  return matcher.match(sees == Sees::kDepth ? cv::Mat() : frame.bgr, sees == Sees::kColors ? cv::Mat() : frame.depth,
                       "32FC1", frame.camera);
}

/// Some frames of a sample's scenes.
std::vector<ClutteredFrame> framesOf(const Sample& sample, int count, ClutterParams params = ClutterParams())
{
  const ClutteredScenes scenes = scenesOf(sample);
  std::vector<ClutteredFrame> frames;
  for (int i = 0; i < count; ++i)
  {
    params.sensor = i % 2 == 0 ? DepthSensor::kKinect : DepthSensor::kStereo;
    frames.push_back(scenes.frame(i, params));
  }
  return frames;
}

/// They are seen in several ways, and take longer to draw than to be searched.
const std::vector<ClutteredFrame>& duckFrames()
{
  static const std::vector<ClutteredFrame> frames = framesOf(duck(), 10);
  return frames;
}

const std::vector<ClutteredFrame>& bottleFrames()
{
  static const std::vector<ClutteredFrame> frames = framesOf(bottle(), 10);
  return frames;
}

/// How many objects are among the candidates.
int foundOf(const Sample& sample, Sees sees, const std::vector<ClutteredFrame>& frames)
{
  ObjectMatcher matcher;
  matcher.add(sample.model);
  return static_cast<int>(std::count_if(frames.begin(), frames.end(),
                                        [&](const ClutteredFrame& frame)
                                        { return hasPose(sample, matchIn(matcher, frame, sees), frame.pose); }));
}

bool equal(const std::vector<PoseCandidate>& a, const std::vector<PoseCandidate>& b)
{
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const PoseCandidate& x, const PoseCandidate& y)
                    {
                      return x.model == y.model && x.view == y.view && x.score == y.score && x.box == y.box &&
                             std::memcmp(x.pose.matrix.val, y.pose.matrix.val, sizeof x.pose.matrix.val) == 0;
                    });
}

/// Only the object, of which some may be beside the image, before a wall.
ClutteredFrame alone(const Sample& sample, const CameraModel& camera, const cv::Affine3d& pose)
{
  ClutteredFrame frame;
  frame.camera = camera;
  frame.pose = pose;
  MeshView view;
  RenderParts parts;
  parts.bgr = true;
  MeshRenderer(sample.mesh).render(MeshCamera(camera), pose, {0, 0, camera.width, camera.height}, view, parts);
  frame.bgr = view.bgr;
  frame.depth = view.depth;
  frame.depth.setTo(1.5, view.depth != view.depth);
  return frame;
}

cv::Affine3d poseAt(const Sample& sample, const cv::Vec3d& middle)
{
  const cv::Affine3d turned(cv::Vec3d(1.9, 0.6, 0.4));
  return {turned.rotation(), middle - turned.rotation() * sample.model.extent.center};
}

CameraModel cameraOf(int width, int height, double f = 262.0)
{
  return {width, height, {f, 0, 0.5 * width - 0.5, 0, f, 0.5 * height - 0.5, 0, 0, 1}, {}, "plumb_bob"};
}

}  // namespace

TEST(ObjectMatcher, hasThePoseAmongItsCandidatesByDepthsAndColors)
{
  EXPECT_GE(foundOf(duck(), Sees::kBoth, duckFrames()), 9);
  EXPECT_GE(foundOf(bottle(), Sees::kBoth, bottleFrames()), 9);
  ClutterParams hidden;
  hidden.occlusion = 0.5;
  EXPECT_GE(foundOf(duck(), Sees::kBoth, framesOf(duck(), 12, hidden)), 11);
}

TEST(ObjectMatcher, hasThePoseAmongItsCandidatesByDepthsOnly)
{
  EXPECT_GE(foundOf(duck(), Sees::kDepth, duckFrames()), 8);
  EXPECT_GE(foundOf(bottle(), Sees::kDepth, bottleFrames()), 8);
}

TEST(ObjectMatcher, hasThePoseAmongItsCandidatesByColorsOnly)
{
  ObjectMatcher matcher;
  matcher.add(duck().model);
  int found = 0;
  for (int i = 0; i < 6; ++i)
  {
    const cv::Matx33d rotation = cv::Affine3d(cv::Vec3d(0.5 * i, 0.7 * i - 2.0, 0.3 * i)).rotation();
    const cv::Vec3d middle(0.02 * i - 0.08, 0.01 * i, 0.5 + 0.05 * i);
    const cv::Affine3d pose(rotation, middle - rotation * duck().model.extent.center);
    const ClutteredFrame frame = alone(duck(), kinectCamera(320), pose);
    found += hasPose(duck(), matchIn(matcher, frame, Sees::kColors), pose) ? 1 : 0;
  }
  EXPECT_GE(found, 4);
  ClutterParams near;
  near.min_distance = 0.45;
  near.max_distance = 0.5;
  EXPECT_GE(foundOf(bottle(), Sees::kColors, framesOf(bottle(), 6, near)), 4);
}

TEST(ObjectMatcher, tellsCandidatesOfEachModelTheBestFirst)
{
  ObjectMatchParams params;
  params.max_candidates = 7;
  ObjectMatcher matcher(params);
  EXPECT_EQ(matcher.add(bottle().model), 0);
  EXPECT_EQ(matcher.add(duck().model), 1);
  EXPECT_EQ(matcher.models(), 2);
  EXPECT_GT(matcher.memory(1), duck().model.memory());
  const ClutteredFrame frame = scenesOf(duck()).frame(1);
  const std::vector<PoseCandidate> candidates = matchIn(matcher, frame);
  int counts[2] = {};
  for (std::size_t i = 0; i < candidates.size(); ++i)
  {
    const PoseCandidate& one = candidates[i];
    ++counts[one.model];
    EXPECT_GE(one.score, 0.0);
    EXPECT_LE(one.score, 1.0);
    EXPECT_GE(one.view, 0);
    EXPECT_LT(one.view, one.model == 0 ? bottle().model.levels.back() : duck().model.levels.back());
    if (i == 0) continue;
    EXPECT_LE(candidates[i - 1].model, one.model);
    if (candidates[i - 1].model == one.model)
    {
      EXPECT_GE(candidates[i - 1].score, one.score);
    }
  }
  EXPECT_EQ(counts[0], 7);
  EXPECT_EQ(counts[1], 7);
  const auto first =
      std::find_if(candidates.begin(), candidates.end(), [](const PoseCandidate& c) { return c.model == 1; });
  const cv::Rect truth = cv::boundingRect(frame.ids == 2), box = first->box;
  EXPECT_TRUE(hasPose(duck(), {*first}, frame.pose));
  EXPECT_GT((truth & box).area(), 0.9 * truth.area()) << box << " " << truth;
  EXPECT_LT(box.area(), 2.5 * truth.area()) << box << " " << truth;
  params.min_score = first->score;
  matcher.configure(params);
  const std::vector<PoseCandidate> best = matchIn(matcher, frame);
  EXPECT_FALSE(best.empty());
  for (const PoseCandidate& one : best)
    EXPECT_GE(one.score, params.min_score);
}

TEST(ObjectMatcher, hasAPoseOfEachPieceOfAnObject)
{
  // Twelve cans that nobody has told to be round: turned about their axes they look nearly the same, which is more
  // poses of a can than there are candidates.
  const Mesh mesh = sampleMesh("can").mesh;
  const ViewModel model = trainViews(mesh, ViewParams());
  const CameraModel camera = objectCamera();
  ObjectScene scene(camera);
  const cv::Vec3d up(0.0, -std::cos(0.7), -std::sin(0.7)), right(1.0, 0.0, 0.0), middle(0.0, 0.0, 1.1);
  const cv::Vec3d away = right.cross(up);
  scene.addTable(middle, up);
  std::vector<cv::Vec3d> places;
  for (int i = 0; i < 12; ++i)
  {
    const cv::Matx33d upright(right[0], away[0], up[0], right[1], away[1], up[1], right[2], away[2], up[2]);
    const cv::Affine3d turned(upright * cv::Affine3d(cv::Vec3d(0.0, 0.0, 0.5 * i)).rotation(),
                              middle + (0.16 * (i % 4) - 0.24) * right + (0.16 * (i / 4) - 0.16) * away);
    const cv::Affine3d pose =
        turned.translate(up * (0.5 * model.extent.size[2]) - turned.rotation() * model.extent.center);
    scene.add(mesh, pose);
    places.push_back(pose * model.extent.center);
  }
  cv::Mat bgr, depth;
  scene.draw(DepthSensor::kKinect, 0, bgr, depth);
  ObjectMatcher matcher;
  matcher.add(model);
  const std::vector<PoseCandidate> candidates = matcher.match(bgr, depth, "32FC1", camera);
  for (const cv::Vec3d& place : places)
    EXPECT_TRUE(std::any_of(candidates.begin(), candidates.end(),
                            [&](const PoseCandidate& one)
                            { return cv::norm(one.pose * model.extent.center - place) < 0.02; }))
        << place;
}

TEST(ObjectMatcher, findsTheSameWithTwoThreadsAndInAnotherOrderOfFrames)
{
  const ThreadCount two(2);
  const ClutteredScenes scenes = scenesOf(duck());
  ObjectMatchParams params;
  ObjectMatcher one(params);
  params.threads = 2;
  ObjectMatcher other(params);
  for (ObjectMatcher* matcher : {&one, &other})
    for (const Sample* sample : {&duck(), &bottle()})
      matcher->add(sample->model);
  const ClutteredFrame first = scenes.frame(0), second = scenes.frame(1);
  const std::vector<PoseCandidate> of_first = matchIn(one, first), of_second = matchIn(one, second);
  matchIn(one, second, Sees::kColors);
  EXPECT_FALSE(equal(of_first, of_second));
  EXPECT_TRUE(equal(matchIn(other, second), of_second));
  EXPECT_TRUE(equal(matchIn(other, first), of_first));
  EXPECT_TRUE(equal(matchIn(one, second), of_second));
}

TEST(ObjectMatcher, seesThroughAnEquidistantLensWhateverItsCoefficients)
{
  ClutteredFrame frame = scenesOf(duck()).frame(2);
  ObjectMatcher matcher;
  matcher.add(duck().model);
  const std::vector<PoseCandidate> of_pinhole = matchIn(matcher, frame);
  frame.camera.distortion_model = "equidistant";
  frame.camera.D = {1e-15, 0.0, 0.0, 0.0};
  const std::vector<PoseCandidate> of_lens = matchIn(matcher, frame);
  frame.camera.D = {0.0, 0.0, 0.0, 0.0};
  EXPECT_TRUE(equal(matchIn(matcher, frame), of_lens));
  EXPECT_FALSE(equal(of_lens, of_pinhole));
}

TEST(ObjectMatcher, takesMillimetresGrayImagesAndPartsOfLargerOnes)
{
  const ClutteredFrame frame = scenesOf(duck()).frame(2);
  ObjectMatcher matcher;
  matcher.add(duck().model);
  cv::Mat gray, millimetres;
  cv::cvtColor(frame.bgr, gray, cv::COLOR_BGR2GRAY);
  frame.depth.convertTo(millimetres, CV_16UC1, 1000.0);
  millimetres.setTo(0, frame.depth != frame.depth);
  EXPECT_TRUE(hasPose(duck(), matcher.match(gray, millimetres, "16UC1", frame.camera), frame.pose));
  cv::Mat large_bgr(260, 340, CV_8UC3, cv::Scalar::all(255)), large_depth(260, 340, CV_32FC1, cv::Scalar(0.3));
  const cv::Rect part(7, 9, 320, 240);
  frame.bgr.copyTo(large_bgr(part));
  frame.depth.copyTo(large_depth(part));
  EXPECT_TRUE(equal(matcher.match(large_bgr(part), large_depth(part), "32FC1", frame.camera), matchIn(matcher, frame)));
}

TEST(ObjectMatcher, takesImagesOfAnySize)
{
  ObjectMatcher matcher;
  matcher.add(duck().model);
  matcher.add(bottle().model);
  for (const cv::Size& size :
       {cv::Size(1, 1), cv::Size(1, 90), cv::Size(2, 3), cv::Size(5, 4), cv::Size(17, 31), cv::Size(63, 1)})
    for (const double f : {262.0, 525.0, 1400.0})
    {
      const CameraModel camera = cameraOf(size.width, size.height, f);
      const ClutteredFrame frame = alone(duck(), camera, poseAt(duck(), {0, 0, 0.6}));
      for (const Sees sees : {Sees::kBoth, Sees::kDepth, Sees::kColors})
        EXPECT_LE(matchIn(matcher, frame, sees).size(), 60U) << size;
    }
  for (const cv::Size& size : {cv::Size(203, 151), cv::Size(331, 97)})
  {
    const ClutteredFrame frame = alone(duck(), cameraOf(size.width, size.height), poseAt(duck(), {0.01, 0.0, 0.6}));
    EXPECT_TRUE(hasPose(duck(), matchIn(matcher, frame), frame.pose)) << size;
    EXPECT_TRUE(hasPose(duck(), matchIn(matcher, frame, Sees::kDepth), frame.pose)) << size;
  }
  CameraModel lens = cameraOf(323, 241);
  lens.D = {-0.25, 0.08, 0.001, -0.001, 0.0};
  const ClutteredFrame frame = alone(duck(), lens, poseAt(duck(), {0.2, 0.1, 0.7}));
  EXPECT_TRUE(hasPose(duck(), matchIn(matcher, frame), frame.pose));
}

TEST(ObjectMatcher, findsWhatIsPartlyOutsideTheImage)
{
  ObjectMatcher matcher;
  matcher.add(duck().model);
  const CameraModel camera = kinectCamera(320);
  const double z = 0.6, right = 0.5 * camera.width / camera.K(0, 0) * z,
               below = 0.5 * camera.height / camera.K(1, 1) * z;
  int found = 0;
  for (const cv::Vec2d& side : {cv::Vec2d(1, 0), cv::Vec2d(-1, 0), cv::Vec2d(0, 1), cv::Vec2d(0, -1)})
  {
    const double inside = 0.2 * duck().model.extent.radius;  // m, from the border to the object's middle
    const cv::Affine3d pose = poseAt(duck(), {side[0] * (right - inside), side[1] * (below - inside), z});
    const ClutteredFrame frame = alone(duck(), camera, pose);
    found += hasPose(duck(), matchIn(matcher, frame), pose) ? 1 : 0;
    matchIn(matcher, frame, Sees::kColors);
  }
  EXPECT_GE(found, 3);
}

TEST(ObjectMatcher, looksOnlyWithinTheMaskAndTheDistances)
{
  const CameraModel camera = kinectCamera(320);
  const ClutteredFrame frame = alone(duck(), camera, poseAt(duck(), {-0.15, 0.0, 0.7}));
  ObjectMatcher matcher;
  matcher.add(duck().model);
  cv::Mat left = cv::Mat::zeros(camera.height, camera.width, CV_8UC1), right = left.clone();
  left.colRange(0, camera.width / 2) = 255;
  right.colRange(camera.width * 3 / 4, camera.width) = 1;
  const auto found = [&](const cv::Mat& mask)
  { return hasPose(duck(), matcher.match(frame.bgr, frame.depth, "32FC1", camera, mask), frame.pose); };
  EXPECT_TRUE(found(cv::Mat()));
  EXPECT_TRUE(found(left));
  EXPECT_FALSE(found(right));
  ObjectMatchParams params;
  params.min_distance = 0.85;
  matcher.configure(params);
  EXPECT_FALSE(found(cv::Mat()));
  params.min_distance = 0.3;
  params.max_distance = 0.55;
  matcher.configure(params);
  EXPECT_FALSE(found(cv::Mat()));
  params.max_distance = 0.8;
  params.min_size = 500;
  matcher.configure(params);
  EXPECT_FALSE(found(cv::Mat()));
  params.min_size = 24;
  matcher.configure(params);
  EXPECT_TRUE(found(cv::Mat()));
}

TEST(ObjectMatcher, findsNothingWhereNothingIs)
{
  const CameraModel camera = kinectCamera(320);
  const cv::Size size(camera.width, camera.height);
  ObjectMatcher matcher;
  const cv::Mat wall(size, CV_32FC1, cv::Scalar(1.0F));
  EXPECT_TRUE(matcher.match({}, wall, "32FC1", camera).empty());  // without models
  matcher.add(duck().model);
  EXPECT_TRUE(matcher.match({}, wall, "32FC1", camera).empty());
  EXPECT_TRUE(matcher.match(cv::Mat::zeros(size, CV_8UC3), {}, "", camera).empty());
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float none : {kNan, infinity, -infinity, 0.0F, -1.0F, 1e30F, std::numeric_limits<float>::denorm_min()})
    EXPECT_TRUE(matcher.match({}, cv::Mat(size, CV_32FC1, cv::Scalar(none)), "32FC1", camera).empty()) << none;
  EXPECT_TRUE(matcher.match({}, cv::Mat::zeros(size, CV_16UC1), "16UC1", camera).empty());
}

TEST(ObjectMatcher, refusesWhatItCannotTake)
{
  EXPECT_EQ(refusalWith(&ObjectMatchParams::max_candidates, 0), "max_candidates is 0, must be from 1 to 1000");
  EXPECT_EQ(refusalWith(&ObjectMatchParams::threads, 65), "threads is 65, must be from 1 to 64");
  EXPECT_EQ(refusalWith(&ObjectMatchParams::min_distance, 3.0), "max_distance is 3, must be above min_distance, 3");
  const CameraModel camera = kinectCamera(320);
  const cv::Mat bgr = cv::Mat::zeros(240, 320, CV_8UC3), depth = cv::Mat::ones(240, 320, CV_32FC1);
  ObjectMatcher matcher;
  const auto reason = [&](const cv::Mat& image, const cv::Mat& depths, const char* encoding, const CameraModel& from,
                          const cv::Mat& mask = cv::Mat())
  { return refusal([&] { matcher.match(image, depths, encoding, from, mask); }); };
  EXPECT_EQ(reason({}, {}, "32FC1", camera), "the frame is empty, must be an image, depths, or both");
  EXPECT_EQ(reason(bgr(cv::Rect(0, 0, 100, 80)), {}, "", camera),
            "the size of the image is 100x80, must be the camera's, 320x240");
  EXPECT_EQ(reason(depth, {}, "", camera), "the type of the image is CV_32FC1, must be CV_8UC3 or CV_8UC1");
  EXPECT_NE(reason(bgr, depth, "16UC1", camera), "");
  EXPECT_NE(reason(bgr, depth, "rgb8", camera), "");
  EXPECT_NE(reason(bgr, depth.rowRange(0, 239), "32FC1", camera), "");
  EXPECT_EQ(reason(bgr, depth, "32FC1", camera, depth), "the type of the mask is CV_32FC1, must be CV_8UC1");
  EXPECT_EQ(reason(bgr, depth, "32FC1", camera, cv::Mat::zeros(10, 12, CV_8UC1)),
            "the size of the mask is 12x10, must be the camera's, 320x240");
  CameraModel unknown = camera;
  unknown.K = cv::Matx33d::zeros();
  EXPECT_EQ(reason(bgr, depth, "32FC1", unknown), "K is 0 everywhere, must be that of a calibrated camera");
  EXPECT_EQ(reason(bgr, depth, "32FC1", camera), "");  // goes on after all of these
  ViewModel half = duck().model;
  half.views.pop_back();
  EXPECT_EQ(refusal([&] { matcher.add(half); }),
            "the number of views of a model is 161, must be 162: its training has not ended");
  EXPECT_EQ(matcher.models(), 0);
  EXPECT_NE(refusal([&] { matcher.memory(0); }), "");
}
