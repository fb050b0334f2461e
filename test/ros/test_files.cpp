#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "robot_vision/common/regular_file.hpp"
#include "robot_vision/common/replace_file.hpp"
#include "ros/params/bounded_yaml.hpp"
#include "ros/params/save_params.hpp"
#include "support/temp_folder.hpp"

using namespace robot_vision;
namespace fs = std::filesystem;

namespace
{

std::vector<std::string> namesIn(const std::string& folder)
{
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

template <class Work>
std::string errorOf(const Work& work)
{
  try
  {
    work();
  }
  catch (const std::exception& e)
  {
    return e.what();
  }
  return "none";
}

std::string repeated(const std::string& text, int times)
{
  std::string all;
  for (int i = 0; i < times; ++i)
    all += text;
  return all;
}

/// A few lines of YAML whose aliases stand for an astronomical number of values.
std::string bomb()
{
  std::string text = "a0: &a0 [1, 2, 3, 4, 5, 6, 7, 8, 9]\n";
  for (int i = 1; i < 80; ++i)
  {
    const std::string alias = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + repeated(alias + ", ", 8) + alias + "]\n";
  }
  return text;
}

}  // namespace

TEST(Files, onlyRegularFilesAreReadAndReplaced)
{
  const TempFolder folder;
  const std::string path = (folder.path() / "odd.yaml").string();
  const std::vector<std::pair<std::string, std::string>> odd = {{"pipe", "it is no file"},
                                                                {"folder", "it is no file"},
                                                                {"/dev/zero", "it is no file"},
                                                                {"nowhere", "it is a symbolic link that leads nowhere"},
                                                                {path, "Too many levels of symbolic links"}};
  for (const auto& [kind, reason] : odd)
  {
    if (kind == "pipe")
      ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
    else if (kind == "folder")
      fs::create_directory(path);
    else
      fs::create_symlink(kind, path);
    const auto type = fs::symlink_status(path).type();
    EXPECT_EQ(errorOf([&] { replaceFile(path, "new"); }), path + " cannot be written: " + reason);
    const std::string unread = kind == "nowhere" ? "No such file or directory" : reason;
    EXPECT_EQ(errorOf([&] { readFile(path, 100); }), path + " cannot be read: " + unread);
    EXPECT_EQ(errorOf([&] { saveParams(path, {}); }), path + " cannot be read: " + unread);
    EXPECT_EQ(fs::symlink_status(path).type(), type);
    EXPECT_EQ(namesIn(folder.path().string()), std::vector<std::string>{"odd.yaml"});
    fs::remove(path);
  }
}

TEST(Files, notMoreThanTheLimitIsRead)
{
  const TempFolder folder;
  const std::string path = (folder.path() / "file").string();
  const std::string data(2 << 20, 'x');
  replaceFile(path, data);
  EXPECT_EQ(readFile(path, data.size()), data);
  EXPECT_EQ(errorOf([&] { readFile(path, data.size() - 1); }),
            path + " cannot be read: it has 2 MB, must have at most 1");
  fs::resize_file(path, std::uintmax_t{1} << 40);  // too large for the memory
  EXPECT_NE(errorOf([&] { readFile(path, 1 << 20); }).find("it has 1048576 MB, must have at most 1"),
            std::string::npos);
  // The kernel states that this file has a size of 0.
  EXPECT_NE(errorOf([&] { readFile("/proc/kallsyms", 1000); }).find("must have at most 0"), std::string::npos);
}

TEST(Files, replacedFilesKeepModeAndOwner)
{
  const TempFolder folder;
  const std::string path = (folder.path() / "file.yaml").string();
  const std::string left = path + "." + std::to_string(getpid()) + ".tmp";
  replaceFile(path, "old");
  replaceFile(left, "of a dead process");
  ASSERT_EQ(chmod(path.c_str(), 0606), 0);
  const bool given = chown(path.c_str(), 1234, 4321) == 0;
  EXPECT_EQ(given, getuid() == 0);
  struct stat before, after;
  ASSERT_EQ(stat(path.c_str(), &before), 0);
  replaceFile(path, "new");
  ASSERT_EQ(stat(path.c_str(), &after), 0);
  EXPECT_EQ(after.st_mode, before.st_mode);
  EXPECT_EQ(after.st_uid, before.st_uid);
  EXPECT_EQ(after.st_gid, before.st_gid);
  EXPECT_EQ(readFile(path, 100), "new");
  EXPECT_EQ(readFile(left, 100), "of a dead process");
  EXPECT_EQ(namesIn(folder.path().string()).size(), 2u);
}

TEST(Files, hostileYamlIsRefusedWithOneLine)
{
  const std::vector<std::pair<std::string, std::string>> hostile = {
      {bomb(), "more than 10000 values"},
      {"[" + repeated("1,", 20000) + "]", "more than 10000 values"},
      {repeated("[", 100000), "nested deeper than 20 levels"},
      {repeated("{a: ", 100000), "nested deeper than 20 levels"},
      {repeated("- ", 100000), "nested deeper than 20 levels"},
      {"a: &a [*a]", "line 1, column 8: an alias of what it is part of"},
  };
  for (const auto& [text, reason] : hostile)
  {
    const std::string error = errorOf([&text = text] { editParams("/a.yaml", text, {}); });
    EXPECT_EQ(error.find("/a.yaml: not overwritten, for it is no valid YAML: "), 0u) << error;
    EXPECT_NE(error.find(reason), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
  requireBoundedYaml("a: &a {b: [1, ~, c]}\nd: *a\n");
  requireBoundedYaml(repeated("[", 20) + repeated("]", 20));
  requireBoundedYaml("");
}
