#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <map>

#include "core/camera/camera_report.hpp"
#include "core/camera/v4l2_cameras.hpp"
#include "robot_vision/camera/frame_source.hpp"
#include "support/fake_v4l2.hpp"
#include "support/temp_folder.hpp"

using namespace robot_vision;

namespace fs = std::filesystem;

namespace
{

/// A fake machine; tests plug cameras into it.
class Machine : public testing::Test
{
protected:
  void SetUp() override
  {
    system_.devices = (root_ / "dev").string();
    system_.classes = (root_ / "class").string();
    system_.open = [this](const std::string& path)
    {
      if (locked_) throw SourceUnavailable(path + ": cannot be opened: Permission denied");
      return cameras_.at(path).plug(path);
    };
  }

  static void write(const fs::path& path, const std::string& line)
  {
    fs::create_directories(path.parent_path());
    std::ofstream(path) << line << "\n";
  }

  std::string node(int number) const { return (root_ / "dev" / ("video" + std::to_string(number))).string(); }

  /// Adds a camera in the USB port `port`, which the kernel describes in /sys.
  FakeCamera& plug(int number, const std::string& card, const std::string& port, const std::string& serial = "")
  {
    const fs::path controller = root_ / "devices/pci0000:00/0000:00:14.0/usb1";
    const fs::path usb = controller / ("1-" + port);
    const fs::path interface = usb / ("1-" + port + ":1.0");
    const std::string name = "video" + std::to_string(number);
    write(controller / "idVendor", "1d6b");
    write(controller / "serial", "0000:00:14.0");
    write(usb / "idVendor", "046d");
    if (!serial.empty()) write(usb / "serial", serial);
    write(root_ / "class" / name / "name", card);
    fs::create_directories(interface);
    fs::create_directory_symlink(interface, root_ / "class" / name / "device");
    write(node(number), "");
    FakeCamera& camera = cameras_[node(number)];
    camera.card = card;
    camera.bus = "usb-0000:00:14.0-" + port;
    return camera;
  }

  /// Makes a symbolic link to a camera below the fake /dev.
  std::string link(const std::string& name, int number) const
  {
    const fs::path path = root_ / "dev" / name;
    fs::create_directories(path.parent_path());
    fs::create_symlink(node(number), path);
    return path.string();
  }

  /// The device that a name means and the warning, or the error message.
  std::string find(const std::string& name) const
  {
    try
    {
      const FoundCamera found = findV4l2Camera(name, system_);
      return found.path + (found.warning.empty() ? "" : " | " + found.warning);
    }
    catch (const SourceUnavailable& e)
    {
      return e.what();
    }
  }

  const TempFolder folder_;
  const fs::path root_ = folder_.path();
  V4l2System system_;
  std::map<std::string, FakeCamera> cameras_;
  bool locked_ = false;
};

}  // namespace

TEST_F(Machine, listsItsCamerasByNumberWithoutOtherDevices)
{
  plug(10, "Microscope", "4");
  plug(2, "HD Pro Webcam C920", "1", "1A2B3C4D");
  plug(3, "HD Pro Webcam C920", "1", "1A2B3C4D").capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  const std::string by_id = link("v4l/by-id/usb-046d_HD_Pro_Webcam_C920_1A2B3C4D-video-index0", 2);
  const std::string by_path = link("v4l/by-path/pci-0000:00:14.0-usb-0:1:1.0-video-index0", 2);
  write(root_ / "dev/videotape", "");
  const std::vector<V4l2Camera> cameras = listV4l2Cameras(system_);
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(describe(cameras[0]), node(2) + " (HD Pro Webcam C920, usb-0000:00:14.0-1, serial 1A2B3C4D)");
  EXPECT_EQ(cameras[0].driver, "fake");
  EXPECT_EQ(cameras[0].links, (std::vector<std::string>{by_id, by_path}));
  EXPECT_EQ(describe(cameras[1]), node(10) + " (Microscope, usb-0000:00:14.0-4)");
}

/// A USB device chooses its names and its serial number.
TEST_F(Machine, namesThatADeviceHasChosenCannotControlATerminal)
{
  plug(0, "Caméra\x1b[2J", "1", "1A\x1b]0;2B");
  const std::vector<V4l2Camera> cameras = listV4l2Cameras(system_);
  ASSERT_EQ(cameras.size(), 1U);
  EXPECT_EQ(cameras[0].card, "Caméra\\x1b[2J");
  EXPECT_EQ(cameras[0].serial, "1A\\x1b]0;2B");
}

TEST_F(Machine, findsACameraByEachOfItsNames)
{
  plug(0, "Integrated Camera", "7");
  plug(2, "HD Pro Webcam C920", "1.2", "1A2B3C4D");
  const std::string by_id = link("v4l/by-id/usb-046d_C920-video-index0", 2);
  for (const std::string& name : {std::string("HD Pro Webcam C920"), std::string("hd pro webcam c920"),
                                  std::string("C920"), std::string("1A2B3C4D"), std::string("usb-0000:00:14.0-1.2"),
                                  std::string("usb-046d_C920-video-index0"), node(2)})
    EXPECT_EQ(find(name), node(2)) << name;
  EXPECT_EQ(find(by_id), by_id);
  EXPECT_EQ(find("Integrated Camera"), node(0));
}

TEST_F(Machine, findsCamerasByTheLinksOfUdevRules)
{
  plug(2, "Webcam", "1");
  plug(4, "Webcam", "2");
  const std::vector<std::string> links = {link("cameras/front", 2), link("front_camera", 2),
                                          link("v4l/by-path/pci-usb-0:1:1.0-video-index0", 2),
                                          link("v4l/by-place/front", 2)};
  link("char/81:2", 2);
  link("shm/somebodys", 2);
  link("a/b/c/too_deep", 2);
  EXPECT_EQ(listV4l2Cameras(system_)[0].links, links);
  for (const std::string& path : links)
  {
    EXPECT_EQ(find(fs::path(path).filename().string()), node(2));
    EXPECT_EQ(find(path), path);
  }
}

TEST_F(Machine, tellsDevicesApart)
{
  const std::string null = link("null", 0);
  fs::remove(null);
  fs::create_symlink("/dev/null", null);
  EXPECT_TRUE(isSameFile(null, "/dev/null"));
  EXPECT_FALSE(isSameFile(null, "/dev/zero"));
  EXPECT_FALSE(isSameFile("/dev/none", "/dev/none"));
}

TEST_F(Machine, reportsTheOthersWhenACameraVanishes)
{
  FakeCamera& gone = plug(0, "Webcam", "1");
  plug(2, "Microscope", "2");
  for (const bool opened : {false, true})
  {
    gone.plugged = true;
    const std::vector<V4l2Camera> cameras = listV4l2Cameras(system_);
    ASSERT_EQ(cameras.size(), 2U);
    gone.plugged = opened;
    gone.faults[VIDIOC_QUERY_EXT_CTRL] = {ENODEV};
    const CameraReport first = reportCamera(cameras[0], system_);
    EXPECT_FALSE(first.complete);
    EXPECT_EQ(first.text, node(0) + ": Webcam\n  driver: fake\n  bus: usb-0000:00:14.0-1\n  " + node(0) +
                              (opened ? ": VIDIOC_QUERY_EXT_CTRL failed" : ": cannot be opened") +
                              ": No such device\n");
    EXPECT_TRUE(reportCamera(cameras[1], system_).complete);
  }
}

TEST_F(Machine, takesTheFirstOfSeveralAndSaysSo)
{
  plug(0, "Webcam", "1", "AA");
  plug(2, "Webcam", "2", "BB");
  plug(4, "Webcam Pro", "3", "CC");
  EXPECT_EQ(find("Webcam"), node(0) + " | 'Webcam' is the name of " + node(0) +
                                " (Webcam, usb-0000:00:14.0-1, serial AA), " + node(2) +
                                " (Webcam, usb-0000:00:14.0-2, serial BB); the first is taken");
  EXPECT_EQ(find("BB"), node(2));
  EXPECT_EQ(find("webcam pro"), node(4));
}

TEST_F(Machine, ignoresMetadataDevices)
{
  plug(0, "Webcam", "1").capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  plug(1, "Webcam", "1");
  EXPECT_EQ(find("Webcam"), node(1));
}

TEST_F(Machine, looksANameUpEachTime)
{
  plug(0, "Webcam", "1", "AA");
  EXPECT_EQ(find("AA"), node(0));
  fs::remove_all(root_);
  cameras_.clear();
  plug(5, "Webcam", "1", "AA");
  EXPECT_EQ(find("AA"), node(5));
}

TEST_F(Machine, namesItsCamerasWhenNoneFits)
{
  EXPECT_EQ(find("C920"), "'C920' is no camera; there is none at all");
  plug(0, "Integrated Camera", "7");
  EXPECT_EQ(find("C920"), "'C920' is no camera; there is " + node(0) + " (Integrated Camera, usb-0000:00:14.0-7)");
  EXPECT_EQ(find("0000:00:14.0").find("'0000:00:14.0' is no camera"), 0U);  // the serial number of the USB controller
}

TEST_F(Machine, listsTheNamesOfACameraThatItMayNotOpen)
{
  plug(0, "Webcam", "1", "AA");
  locked_ = true;
  EXPECT_EQ(find("AA"), node(0));
  EXPECT_EQ(find("Webcam"), node(0));
  const V4l2Camera camera = listV4l2Cameras(system_).front();
  EXPECT_EQ(camera.problem, node(0) + ": cannot be opened: Permission denied");
}
