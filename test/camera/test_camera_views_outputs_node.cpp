#include <gtest/gtest.h>
#include <robot_vision/GroundTruth.h>
#include <ros/ros.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/SetCameraInfo.h>
#include <sys/mman.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "robot_vision/codecs/compressed_depth.hpp"
#include "ros/camera/camera_outputs.hpp"
#include "support/images.hpp"
#include "support/receiver.hpp"
#include "support/refusal.hpp"
#include "support/run_tests.hpp"
#include "support/temp_folder.hpp"

using namespace robot_vision;
using sensor_msgs::CameraInfo;
using sensor_msgs::Image;

namespace
{

const ros::Time kStamp(12, 34);
const cv::Mat kFirst = noise({64, 48}, CV_8UC3);
const cv::Mat kSecond = kFirst + cv::Scalar(1, 2, 3);
const cv::Mat kDepths = noise({32, 24}, CV_16UC1);

Frame frameOf(const cv::Mat& first, const EncodedImage& second)
{
  Frame frame;
  frame.image = first;
  frame.encoding = "bgr8";
  frame.second = second;
  return frame;
}

/// A camera with a focal length of 100 px and a lens that bends lines.
CameraModel camera(int width, int height)
{
  CameraModel model;
  model.width = width;
  model.height = height;
  model.K = {100, 0, width / 2.0, 0, 100, height / 2.0, 0, 0, 1};
  model.D = {-0.1, 0.01, 0, 0, 0};
  return model;
}

/// The calibration of a camera without distortion, as it is sent to set_camera_info.
sensor_msgs::SetCameraInfo calibrationOf(unsigned width, unsigned height, double focal_length)
{
  sensor_msgs::SetCameraInfo request;
  CameraInfo& info = request.request.camera_info;
  info.width = width;
  info.height = height;
  info.K = {focal_length, 0, width / 2.0, 0, focal_length, height / 2.0, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {focal_length, 0, width / 2.0, 0, 0, focal_length, height / 2.0, 0, 0, 0, 1, 0};
  info.D.assign(5, 0.0);
  info.distortion_model = "plumb_bob";
  return request;
}

/// A Kinect's color camera in its housing.
const Housing kHousing = {cv::Affine3d(cv::Matx33d(0, 0, 1, -1, 0, 0, 0, -1, 0), cv::Vec3d(0, -0.045, 0))};

/// A Kinect's depth camera beside that.
SecondCamera depthCamera()
{
  return {camera(32, 24), cv::Affine3d().translate({-0.025, 0, 0})};
}

/// The same camera 0.1 m to the right.
SecondCamera rightOf(const CameraModel& left)
{
  return {left, cv::Affine3d().translate({0.1, 0, 0})};
}

}  // namespace

/// The outputs of a camera with two views in the test's private namespace.
class Views : public testing::Test
{
protected:
  void make(const std::string& views, const std::string& url = "", const std::string& right_frame = "left")
  {
    CameraOutputs::Params params;
    params.views = views;
    params.camera_info_url = url;
    params.right_frame = right_frame;
    outputs_ = std::make_unique<CameraOutputs>(ros::NodeHandle("~"), params, [] {});
    ASSERT_FALSE(outputs_->wanted());
  }

  /// Publishes the frame until the condition is true.
  bool publishUntil(Frame frame, const std::function<bool()>& condition)
  {
    return waitFor(
        [&]
        {
          frame.wanted = outputs_->wantedViews();
          outputs_->publish(frame, kStamp);
          return condition();
        });
  }

  /// Waits until exactly these views are wanted.
  bool waitUntilWanted(bool first, bool second)
  {
    return waitFor(
        [&]
        {
          const WantedViews wanted = outputs_->wantedViews();
          return outputs_->wanted() && wanted.first == first && wanted.second == second;
        });
  }

  /// Whether a topic of the private namespace is advertised.
  static bool hasTopic(const std::string& name)
  {
    ros::V_string all;
    ros::this_node::getAdvertisedTopics(all);
    return std::count(all.begin(), all.end(), ros::NodeHandle("~").resolveName(name)) == 1;
  }

  std::unique_ptr<CameraOutputs> outputs_;
};

TEST_F(Views, areAPairWithTheSameStampAndFrame)
{
  make("stereo");
  const Receiver<Image> left("left/image_raw"), right("right/image_raw"), gray("right/image_mono");
  const Receiver<CameraInfo> left_info("left/camera_info"), right_info("right/camera_info");
  ASSERT_TRUE(
      publishUntil(frameOf(kFirst, {kSecond, "bgr8"}), [&]
                   { return left.last() && right.last() && gray.last() && left_info.last() && right_info.last(); }));
  EXPECT_TRUE(equal(viewPixels(*left.last()), kFirst));
  EXPECT_TRUE(equal(viewPixels(*right.last()), kSecond));
  EXPECT_TRUE(equal(viewPixels(*gray.last()), converted(kSecond, cv::COLOR_BGR2GRAY)));
  for (const auto& header : {left.last()->header, right.last()->header, gray.last()->header, left_info.last()->header,
                             right_info.last()->header})
  {
    EXPECT_EQ(header.stamp, kStamp);
    EXPECT_EQ(header.frame_id, "head_camera");
  }
}

TEST_F(Views, areInTwoFramesIfTheRightOneIsToHaveItsOwn)
{
  make("stereo", "", "own");
  const Receiver<Image> left("left/image_raw"), right("right/image_raw");
  const Receiver<CameraInfo> left_info("left/camera_info"), right_info("right/camera_info");
  ASSERT_TRUE(publishUntil(frameOf(kFirst, {kSecond, "bgr8"}),
                           [&] { return left.last() && right.last() && left_info.last() && right_info.last(); }));
  for (const auto& header : {left.last()->header, left_info.last()->header})
    EXPECT_EQ(header.frame_id, "head_camera");
  for (const auto& header : {right.last()->header, right_info.last()->header})
    EXPECT_EQ(header.frame_id, "head_camera_right_optical_frame");
}

TEST_F(Views, haveNoOtherFrames)
{
  EXPECT_EQ(refusal([&] { make("stereo", "", "middle"); }), "right_frame is 'middle', must be left or own");
}

TEST_F(Views, areColorAndDepthWhichIsNeitherGrayNorJpegNorVideo)
{
  make("rgbd");
  const std::vector<std::string> there = {"rgb/camera_info",   "rgb/image_raw",   "rgb/image_raw/compressed",
                                          "rgb/image_mono",    "depth/image_raw", "depth/image_raw/compressedDepth",
                                          "depth/camera_info", "ground_truth"};
  const std::vector<std::string> not_there = {"image_raw",        "camera_info",
                                              "depth/image_mono", "depth/image_raw/compressed",
                                              "rgb/ground_truth", "depth/image_raw/theora",
                                              "image_mono",       "rgb/image_raw/compressedDepth"};
  for (const std::string& topic : there)
    EXPECT_TRUE(hasTopic(topic)) << topic;
  for (const std::string& topic : not_there)
    EXPECT_FALSE(hasTopic(topic)) << topic;

  const Receiver<Image> rgb("rgb/image_raw"), depth("depth/image_raw");
  const Receiver<sensor_msgs::CompressedImage> compressed("depth/image_raw/compressedDepth");
  const Receiver<CameraInfo> info("depth/camera_info");
  ASSERT_TRUE(publishUntil(frameOf(kFirst, {kDepths, "16UC1"}),
                           [&] { return rgb.last() && depth.last() && compressed.last() && info.last(); }));
  EXPECT_EQ(depth.last()->encoding, "16UC1");
  EXPECT_TRUE(equal(viewAnyPixels(*depth.last()), kDepths));
  EXPECT_EQ(compressed.last()->format, "16UC1; compressedDepth png");
  cv::Mat back;
  decompressDepth(compressed.last()->format, compressed.last()->data.data(), compressed.last()->data.size(), back);
  cv::Mat within = kDepths.clone();
  within.setTo(0, kDepths > 10000);  // mm, depth_max
  EXPECT_TRUE(equal(back, within));
  EXPECT_EQ(info.last()->width, 32u);
  for (const auto& header : {depth.last()->header, compressed.last()->header, info.last()->header})
  {
    EXPECT_EQ(header.stamp, rgb.last()->header.stamp);
    EXPECT_EQ(header.frame_id, "head_camera_depth_optical_frame");
  }
}

TEST_F(Views, ofASceneAreCalibratedTogether)
{
  make("stereo");
  const CameraModel left = camera(64, 48);
  const SecondCamera right = rightOf(left);
  outputs_->setCameras(&left, &right);
  const Receiver<CameraInfo> left_info("left/camera_info"), right_info("right/camera_info");
  ASSERT_TRUE(publishUntil(frameOf(kFirst, {kSecond, "bgr8"}), [&] { return left_info.last() && right_info.last(); }));
  for (const auto& info : {*left_info.last(), *right_info.last()})
  {
    EXPECT_TRUE(std::equal(info.K.begin(), info.K.end(), left.K.val));
    EXPECT_EQ(info.D, left.D);
    EXPECT_EQ(info.R, (CameraInfo::_R_type{1, 0, 0, 0, 1, 0, 0, 0, 1}));
  }
  auto expected = left_info.last()->P;
  EXPECT_EQ(expected, (CameraInfo::_P_type{100, 0, 32, 0, 0, 100, 24, 0, 0, 0, 1, 0}));
  expected[3] = -100 * 0.1;  // Tx = -fx B
  EXPECT_EQ(right_info.last()->P, expected);
}

TEST_F(Views, ofColorAndDepthAreNoStereoPair)
{
  make("rgbd");
  const CameraModel color = camera(64, 48);
  const SecondCamera depth = depthCamera();
  outputs_->setCameras(&color, &depth);
  const Receiver<CameraInfo> info("depth/camera_info");
  ASSERT_TRUE(publishUntil(frameOf(kFirst, {kDepths, "16UC1"}), [&] { return info.last() != nullptr; }));
  EXPECT_EQ(info.last()->P, (CameraInfo::_P_type{100, 0, 16, 0, 0, 100, 12, 0, 0, 0, 1, 0}));
}

TEST_F(Views, areAtThePlacesThatTheSourceKnows)
{
  make("stereo");
  tf2_ros::Buffer buffer;
  const tf2_ros::TransformListener listener(buffer);
  const std::string parent = "head_camera", child = "head_camera_right_optical_frame";
  const CameraModel left = camera(64, 48);
  outputs_->setCameras(&left, nullptr);
  EXPECT_FALSE(buffer.canTransform(parent, child, ros::Time(0)));
  const SecondCamera right = rightOf(left);
  outputs_->setCameras(&left, &right);
  ASSERT_TRUE(waitFor([&] { return buffer.canTransform(parent, child, ros::Time(0)); }));
  const auto found = buffer.lookupTransform(parent, child, ros::Time(0)).transform;
  EXPECT_NEAR(found.translation.x, 0.1, 1e-12);
  EXPECT_NEAR(found.translation.y, 0.0, 1e-12);
  EXPECT_NEAR(found.rotation.w, 1.0, 1e-12);
}

TEST_F(Views, ofADeviceAreAtTheirPlacesInItsHousing)
{
  make("rgbd");
  tf2_ros::Buffer buffer;
  const tf2_ros::TransformListener listener(buffer);
  const CameraModel color = camera(64, 48);
  const SecondCamera depth = depthCamera();
  outputs_->setCameras(&color, &depth, &kHousing);
  const std::string link = "head_camera_link", optical = "head_camera_depth_optical_frame";
  ASSERT_TRUE(waitFor([&] { return buffer.canTransform(link, optical, ros::Time(0)); }));
  const auto place = [&](const std::string& parent, const std::string& child)
  { return buffer.lookupTransform(parent, child, ros::Time(0)).transform; };
  EXPECT_NEAR(place(link, "head_camera_rgb_frame").translation.y, -0.045, 1e-12);
  EXPECT_NEAR(place(link, "head_camera_rgb_frame").rotation.w, 1.0, 1e-12);
  EXPECT_NEAR(place(link, "head_camera_depth_frame").translation.y, -0.02, 1e-12);
  EXPECT_NEAR(place("head_camera", optical).translation.x, -0.025, 1e-12);
  EXPECT_NEAR(place("head_camera", optical).rotation.w, 1.0, 1e-12);
  EXPECT_NEAR(std::abs(place(link, optical).rotation.x), 0.5, 1e-12);
}

TEST_F(Views, areNotAtAnyPlaceIfOthersTell)
{
  CameraOutputs::Params params;
  params.views = "rgbd";
  params.publish_tf = false;
  params.second_frame_id = "robot_eye";
  outputs_ = std::make_unique<CameraOutputs>(ros::NodeHandle("~"), params, [] {});
  const CameraModel color = camera(64, 48);
  const SecondCamera depth = depthCamera();
  outputs_->setCameras(&color, &depth, &kHousing);
  const Receiver<CameraInfo> info("depth/camera_info");
  ASSERT_TRUE(publishUntil(frameOf(kFirst, {kDepths, "16UC1"}), [&] { return info.last() != nullptr; }));
  EXPECT_EQ(info.last()->header.frame_id, "robot_eye");
  ros::V_string topics;
  ros::this_node::getAdvertisedTopics(topics);
  EXPECT_EQ(std::count(topics.begin(), topics.end(), "/tf_static"), 0);
}

// What is known of all cameras of a make is worse than the calibration of this one.
TEST_F(Views, haveTheirOwnCalibrationInPlaceOfThatOfTheirMake)
{
  const TempFolder folder;
  make("rgbd", "file://" + folder.path().string() + "/${NAME}.yaml");
  sensor_msgs::SetCameraInfo request = calibrationOf(64, 48, 90);
  ASSERT_TRUE(ros::service::call(ros::NodeHandle("~").resolveName("rgb/set_camera_info"), request));
  EXPECT_TRUE(request.response.success) << request.response.status_message;
  const CameraModel color = camera(64, 48);
  const SecondCamera depth = depthCamera();
  outputs_->setCameras(&color, &depth, &kHousing);
  const Receiver<CameraInfo> rgb("rgb/camera_info"), depths("depth/camera_info");
  ASSERT_TRUE(publishUntil(frameOf(kFirst, {kDepths, "16UC1"}), [&] { return rgb.last() && depths.last(); }));
  EXPECT_EQ(rgb.last()->K[0], 90.0);
  EXPECT_EQ(depths.last()->K[0], 100.0);
}

// A view that nobody watches is not touched: its memory cannot even be read.
TEST_F(Views, areNotMadeUnlessSomebodySubscribes)
{
  constexpr std::size_t kBytes = 64 * 48 * 3;
  void* const unreadable = mmap(nullptr, kBytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(unreadable, MAP_FAILED);
  const cv::Mat hidden(48, 64, CV_8UC3, unreadable);
  make("stereo");
  EXPECT_FALSE(outputs_->wantedViews().first || outputs_->wantedViews().second);
  {
    const Receiver<Image> right("right/image_raw");
    ASSERT_TRUE(waitUntilWanted(false, true));
    EXPECT_TRUE(publishUntil(frameOf(hidden, {kSecond, "bgr8"}), [&] { return right.last() != nullptr; }));
  }
  {
    const Receiver<Image> left("left/image_mono");
    ASSERT_TRUE(waitUntilWanted(true, false));
    EXPECT_TRUE(publishUntil(frameOf(kFirst, {hidden, "bgr8"}), [&] { return left.last() != nullptr; }));
  }
  ASSERT_TRUE(waitFor([&] { return !outputs_->wanted(); }));
  munmap(unreadable, kBytes);
}

TEST_F(Views, areNotWantedByThoseWhoWantTheGroundTruth)
{
  make("rgbd");
  const Receiver<GroundTruth> truth("ground_truth");
  ASSERT_TRUE(waitUntilWanted(false, false));
  Frame frame;
  frame.truth = std::make_shared<const SceneTruth>();
  ASSERT_TRUE(publishUntil(frame, [&] { return truth.last() != nullptr; }));
  EXPECT_EQ(truth.last()->header.frame_id, "head_camera");
}

TEST_F(Views, doNotFailBecauseTheOtherOneIsDamaged)
{
  make("stereo");
  const Receiver<Image> left("left/image_raw"), right("right/image_raw");
  ASSERT_TRUE(waitUntilWanted(true, true));
  std::string reason;
  ASSERT_TRUE(waitFor(
      [&]
      {
        reason = refusal([&] { outputs_->publish(frameOf(cv::Mat(48, 64, CV_8UC1), {kSecond, "bgr8"}), kStamp); });
        return right.last() != nullptr;
      }));
  EXPECT_NE(reason.find("expected pixels of 3 x 8 bits"), std::string::npos) << reason;
  EXPECT_FALSE(left.last());
}

TEST_F(Views, haveACalibrationForEach)
{
  const TempFolder folder;
  make("stereo", "file://" + folder.path().string() + "/${NAME}.yaml");
  ros::NodeHandle nh("~");
  sensor_msgs::SetCameraInfo request = calibrationOf(64, 48, 90);
  request.request.camera_info.P[3] = -9;
  ASSERT_TRUE(ros::service::call(nh.resolveName("right/set_camera_info"), request));
  EXPECT_TRUE(request.response.success) << request.response.status_message;
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "head_camera_right.yaml"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "head_camera_left.yaml"));
  const Receiver<CameraInfo> left("left/camera_info"), right("right/camera_info");
  ASSERT_TRUE(publishUntil(frameOf(kFirst, {kSecond, "bgr8"}), [&] { return left.last() && right.last(); }));
  EXPECT_EQ(left.last()->K[0], 0.0);
  EXPECT_EQ(right.last()->K[0], 90.0);
  EXPECT_EQ(right.last()->P[3], -9.0);
}

TEST_F(Views, cannotHaveOneFileForBothCalibrations)
{
  EXPECT_EQ(refusal([&] { make("rgbd", "file:///a.yaml"); }),
            "camera_info_url is 'file:///a.yaml', must be empty or have ${NAME} in it, which becomes head_camera_rgb "
            "and head_camera_depth");
}

TEST_F(Views, giveMemoryOfTheNextMessagesToTheSource)
{
  make("rgbd");
  const Receiver<Image> rgb("rgb/image_raw"), depth("depth/image_raw");
  ASSERT_TRUE(publishUntil(frameOf(kFirst, {kDepths, "16UC1"}), [&] { return rgb.last() && depth.last(); }));
  Frame frame;
  outputs_->prepare(frame);
  EXPECT_EQ(frame.image.size(), kFirst.size());
  EXPECT_EQ(frame.image.type(), CV_8UC3);
  EXPECT_EQ(frame.second.pixels.size(), kDepths.size());
  EXPECT_EQ(frame.second.pixels.type(), CV_16UC1);
}

// A depth camera with one view, such as one that gives Z16.
TEST_F(Views, ofDepthsAloneAreCompressedAsDepths)
{
  CameraOutputs::Params params;
  params.depths = true;
  outputs_ = std::make_unique<CameraOutputs>(ros::NodeHandle("~"), params, [] {});
  EXPECT_FALSE(hasTopic("image_mono") || hasTopic("image_raw/compressed") || hasTopic("image_raw/theora"));
  const Receiver<Image> raw("image_raw");
  const Receiver<sensor_msgs::CompressedImage> compressed("image_raw/compressedDepth");
  Frame frame;
  frame.image = kDepths;
  frame.encoding = "16UC1";
  ASSERT_TRUE(publishUntil(frame, [&] { return raw.last() && compressed.last(); }));
  EXPECT_TRUE(equal(viewAnyPixels(*raw.last()), kDepths));
  EXPECT_EQ(raw.last()->header.frame_id, "head_camera");
}

TEST_F(Views, ofDepthsHaveNoGrayEvenIfNobodyHasSaidWhatTheyAre)
{
  make("one");
  const Receiver<Image> mono("image_mono");
  ASSERT_TRUE(waitFor([&] { return outputs_->wanted(); }));
  const Receiver<Image> raw("image_raw");
  Frame frame;
  frame.image = kDepths;
  frame.encoding = "16UC1";
  ASSERT_TRUE(publishUntil(frame, [&] { return raw.last() != nullptr; }));
  EXPECT_EQ(raw.last()->encoding, "16UC1");
  EXPECT_FALSE(mono.last());
}

int main(int argc, char** argv)
{
  return runTests(argc, argv, "camera_views_outputs");
}
