#include "robot_vision/code_reader.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "pictures.hpp"
#include "refusal.hpp"
#include "robot_vision/scene.hpp"

using namespace robot_vision;

namespace
{

CodeReader readerOf(const std::string& symbologies)
{
  CodeReaderParams params;
  params.symbologies = symbologies;
  return CodeReader(params);
}

/// The scene's QR code, and its corners as the reader orders them.
std::vector<cv::Point2d> truth(const Scene& scene, std::int64_t frame)
{
  for (const SceneObject& object : scene.truth(frame).objects)
    if (object.name == "qr_code") return {object.outline.rbegin(), object.outline.rend()};
  return {};
}

}  // namespace

TEST(CodeReader, readsTheSceneWhereItsCodeIs)
{
  const Scene scene{SceneParams()};
  CodeReader reader;
  for (const std::int64_t frame : {0, 150, 300, 450})
  {
    cv::Mat bgr;
    scene.render(frame, bgr);
    const cv::Mat before = bgr.clone();
    const std::vector<Code> codes = reader.read(bgr, "bgr8");
    EXPECT_TRUE(equal(bgr, before));
    ASSERT_EQ(codes.size(), 1U);
    EXPECT_EQ(codes[0].type, "qr");
    EXPECT_EQ(codes[0].data, "robot_vision");
    EXPECT_EQ(codes[0].score, 1.0);
    const std::vector<cv::Point2d> corners = truth(scene, frame);
    ASSERT_EQ(codes[0].polygon.size(), corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i)
      EXPECT_LT(cv::norm(codes[0].polygon[i] - corners[i]), 3.0) << frame << codes[0].polygon[i] << corners[i];
  }
}

TEST(CodeReader, readsPartsOfPictures)
{
  const Scene scene{SceneParams()};
  cv::Mat bgr, gray;
  scene.render(0, bgr);
  cv::cvtColor(bgr, gray, cv::COLOR_BGR2GRAY);
  const std::vector<cv::Point2d> corners = truth(scene, 0);
  const cv::Rect tight = cv::boundingRect(std::vector<cv::Point2f>(corners.begin(), corners.end()));
  const cv::Rect around = tight + cv::Size(40, 40) - cv::Point(20, 20);
  const std::vector<Code> codes = CodeReader().read(gray(around), "mono8");  // its rows lie apart
  ASSERT_EQ(codes.size(), 1U);
  EXPECT_EQ(codes[0].data, "robot_vision");
  EXPECT_LT(cv::norm(codes[0].polygon[0] + cv::Point2d(around.tl()) - corners[0]), 3.0);
}

TEST(CodeReader, keepsNothingOfAPicture)
{
  CodeReader reader;
  const Scene scene{SceneParams()};
  cv::Mat bgr;
  scene.render(0, bgr);
  EXPECT_EQ(reader.read(bgr, "bgr8").size(), 1U);
  bgr.release();
  EXPECT_TRUE(reader.read(cv::Mat(48, 64, CV_8UC1, cv::Scalar(255)), "mono8").empty());
  CodeReader other = std::move(reader);
  scene.render(1, bgr);
  EXPECT_EQ(other.read(bgr, "bgr8").size(), 1U);
}

TEST(CodeReader, looksForWhatIsWanted)
{
  cv::Mat bgr;
  Scene{SceneParams()}.render(0, bgr);
  EXPECT_EQ(readerOf("qr").read(bgr, "bgr8").size(), 1U);
  EXPECT_EQ(readerOf(" code128 , qr ").read(bgr, "bgr8").size(), 1U);
  EXPECT_TRUE(readerOf("code128").read(bgr, "bgr8").empty());
}

TEST(CodeReader, refusesWhatIsOutOfRange)
{
  const std::string types = "qr, ean13, ean8, upca, upce, code128, code93, code39, i25, codabar";
  EXPECT_EQ(refusal([] { readerOf("aztec"); }), "symbologies has 'aztec', must be all, or some with commas: " + types);
  EXPECT_EQ(refusal([] { readerOf(""); }), "symbologies has '', must be all, or some with commas: " + types);
  CodeReaderParams params;
  params.spacing = 17;
  EXPECT_EQ(refusal([&] { validate(params); }), "spacing is 17, must be from 1 to 16");
  params.spacing = 16;
  params.enlarge = 0;
  EXPECT_EQ(refusal([&] { validate(params); }), "enlarge is 0, must be from 1 to 4");
  EXPECT_THROW(CodeReader().read(cv::Mat(), "mono8"), std::invalid_argument);
  EXPECT_THROW(CodeReader().read(cv::Mat(40, 40, CV_8UC1), "bgr8"), std::invalid_argument);
}
