#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <string>

/// What a command prints.
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

// The linker keeps one copy of a weak function for all of the library: it must not be one with instructions that the
// machine may not have.
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
