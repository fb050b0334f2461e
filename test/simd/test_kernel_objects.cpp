#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>

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
  for (const std::string object : {KERNEL_OBJECTS})
  {
    const std::string symbols = outputOf("nm --defined-only " + object);
    EXPECT_NE(symbols.find("KernelTable"), std::string::npos) << object << ": no table";
    for (const char* const weak : {" W ", " w ", " V ", " v ", " u "})
      EXPECT_EQ(symbols.find(weak), std::string::npos) << object << ":\n" << symbols;
  }
}
