#include "core/camera/scene_meshes.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "robot_vision/camera/open_source.hpp"
#include "robot_vision/meshes/sample_meshes.hpp"
#include "support/refusal.hpp"
#include "support/temp_folder.hpp"

using namespace robot_vision;

namespace
{

std::vector<std::string> namesOf(const std::string& list)
{
  std::vector<std::string> names;
  for (const TabletopMesh& mesh : readSceneMeshes(list).meshes)
    names.push_back(mesh.name);
  return names;
}

std::string refusalOf(const std::string& list)
{
  return refusal<SourceError>([&] { readSceneMeshes(list); });
}

}  // namespace

TEST(SceneMeshes, areSamplesByTheirNames)
{
  EXPECT_EQ(namesOf(""), sampleMeshNames());
  EXPECT_EQ(namesOf(" nut ,box,nut"), (std::vector<std::string>{"nut", "box", "nut_2"}));
}

TEST(SceneMeshes, areRefusedWithTheNameOfTheOneThatIsWrong)
{
  EXPECT_EQ(refusalOf("nut,,box"), "meshes: there is nothing between two commas");
  EXPECT_EQ(refusalOf("nut,/nowhere/cup.stl"), "meshes: /nowhere/cup.stl cannot be read: No such file or directory");
  EXPECT_EQ(refusalOf("/dev/null"), "meshes: /dev/null cannot be read: it is no file");
}

TEST(SceneSource, movesOnAtAnotherRateWithoutItsFiles)
{
  const TempFolder folder;
  const std::filesystem::path file = folder.path() / "poster.png";
  cv::imwrite(file.string(), cv::Mat(64, 64, CV_8UC3, cv::Scalar(10, 20, 30)));
  CaptureParams params;
  params.source = "synthetic";
  params.scene = "room";
  params.poster = file.string();
  params.image_width = 128;
  params.image_height = 96;
  const std::unique_ptr<FrameSource> source = openSource(params);
  std::filesystem::remove(file);
  Frame frame;
  for (int number = 0; number < 6; ++number)
    ASSERT_EQ(source->read(frame), ReadResult::kFrame);
  ASSERT_TRUE(source->setRate(15.0));
  EXPECT_EQ(source->description(), "synthetic scene (room) 128x96 at 15 Hz");
  ASSERT_EQ(source->read(frame), ReadResult::kFrame);
  EXPECT_EQ(frame.sequence, 6);
  EXPECT_EQ(frame.truth->frame, 3);
  SceneParams slow;
  slow.width = params.image_width;
  slow.height = params.image_height;
  slow.rate = 15.0;
  EXPECT_EQ(frame.truth->camera.matrix, Scene(slow).truth(3).camera.matrix);
}

TEST(SceneMeshes, standOnTheTableOfTheSource)
{
  CaptureParams params;
  params.source = "synthetic";
  params.scene = "tabletop";
  params.meshes = "duck,nut";
  params.views = "rgbd";
  params.image_width = 128;
  params.image_height = 96;
  const std::unique_ptr<FrameSource> source = openSource(params);
  EXPECT_EQ(source->description(), "synthetic scene (tabletop) 128x96 and 128x96 at 30 Hz");
  EXPECT_EQ(source->warning(), "");
  Frame frame;
  ASSERT_EQ(source->read(frame), ReadResult::kFrame);
  ASSERT_EQ(frame.truth->objects.size(), 2U);
  EXPECT_EQ(frame.truth->objects[0].name, "duck");
  EXPECT_EQ(frame.truth->objects[1].name, "nut");
  params.meshes = "drill,drill,drill,drill,drill,drill,drill,drill,drill,drill,drill,drill,drill,drill,drill,drill";
  EXPECT_EQ(refusal([&] { openSource(params); }),
            "mesh drill_10 is 0.2 m across, must be small enough for the room that is left on the table");
}
