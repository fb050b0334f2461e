#include <fcntl.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

#include "core/camera/device_access.hpp"
#include "core/camera/v4l2_device.hpp"
#include "robot_vision/camera/frame_source.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

namespace
{

/// A file that stands for a device.
class DeviceAccess : public testing::Test
{
protected:
  void SetUp() override
  {
    const int fd = mkstemp(path_);
    ASSERT_NE(fd, -1);
    close(fd);
  }

  void TearDown() override { unlink(path_); }

  char path_[32] = "/tmp/robot_vision_video_XXXXXX";
};

constexpr uid_t kNobody = 65534;

}  // namespace

TEST_F(DeviceAccess, isExplainedToUsersWithoutPermission)
{
  if (geteuid() != 0) GTEST_SKIP() << "only root can change the owner of a file";
  const group* video = getgrnam("video");
  ASSERT_NE(video, nullptr);
  ASSERT_EQ(chown(path_, 0, video->gr_gid), 0);
  ASSERT_EQ(chmod(path_, 0660), 0);
  ASSERT_EQ(seteuid(kNobody), 0);
  const std::string error = refusal<SourceUnavailable>([this] { openV4l2Device(path_); });
  ASSERT_EQ(seteuid(0), 0);
  EXPECT_EQ(error, std::string(path_) +
                       ": cannot be opened: Permission denied; its group is video, its mode 0660: join with `sudo "
                       "usermod -aG video $USER` and log in again, or write the udev rule SUBSYSTEM==\"video4linux\", "
                       "GROUP=\"video\", MODE=\"0660\"");
  ASSERT_EQ(chmod(path_, 0600), 0);  // joining the group would not help
  EXPECT_EQ(accessAdvice(path_, EACCES),
            "; its group is video, its mode 0600: write the udev rule SUBSYSTEM==\"video4linux\", GROUP=\"video\", "
            "MODE=\"0660\"");
}

TEST_F(DeviceAccess, namesTheProcessThatHoldsABusyDevice)
{
  EXPECT_EQ(accessAdvice(path_, EBUSY), std::string("; `sudo fuser -v ") + path_ + "` tells who holds it");
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t holder = fork();
  if (holder == 0)
  {
    const bool opened = open(path_, O_RDWR) != -1;
    _exit(opened && write(ready[1], "x", 1) == 1 ? pause() : 1);
  }
  char byte;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  const std::string advice = accessAdvice(path_, EBUSY);
  const std::string link = std::string(path_) + "_link";
  ASSERT_EQ(symlink(path_, link.c_str()), 0);
  const std::string advice_for_link = accessAdvice(link, EBUSY);
  unlink(link.c_str());
  kill(holder, SIGKILL);
  waitpid(holder, nullptr, 0);
  close(ready[0]);
  close(ready[1]);
  EXPECT_EQ(advice, "; it is open in test_camera (process " + std::to_string(holder) + ")");
  EXPECT_EQ(advice_for_link, advice);
}

TEST_F(DeviceAccess, hasNoAdviceForOtherErrors)
{
  EXPECT_EQ(accessAdvice(path_, EIO), "");
  EXPECT_EQ(accessAdvice("/dev/robot_vision_no_such_device", EACCES), "");
}
