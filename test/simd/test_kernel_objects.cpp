#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <map>
#include <sstream>
#include <string>
#include <vector>

/// The standard output of a command, which must succeed.
std::string outputOf(const std::string& command)
{
  std::string output;
  std::array<char, 4096> part;
  FILE* const pipe = popen(command.c_str(), "r");
  while (std::fgets(part.data(), static_cast<int>(part.size()), pipe) != nullptr)
    output += part.data();
  EXPECT_EQ(pclose(pipe), 0) << command;
  return output;
}

// The linker keeps a single copy of a weak function for the whole library. That copy could have instructions that the
// machine does not have.
TEST(KernelObjects, shareNoFunctions)
{
  const std::vector<std::string> objects = {KERNEL_OBJECTS};
  std::string command = "nm --defined-only --print-file-name";  // one for all: it takes longer to start than to look
  for (const std::string& object : objects)
    command += ' ' + object;
  std::map<std::string, std::string> symbols;
  std::istringstream lines(outputOf(command));
  for (std::string line; std::getline(lines, line);)
    symbols[line.substr(0, line.find(".o:") + 2)] += line + '\n';
  for (const std::string& object : objects)
  {
    EXPECT_NE(symbols[object].find("KernelTable"), std::string::npos) << object << ": no table";
    for (const char* const weak : {" W ", " w ", " V ", " v ", " u "})
      EXPECT_EQ(symbols[object].find(weak), std::string::npos) << object << ":\n" << symbols[object];
  }
}
