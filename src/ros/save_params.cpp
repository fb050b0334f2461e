#include "save_params.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

namespace robot_vision
{
namespace
{

using Values = std::vector<std::pair<std::string, std::string>>;  // name and value as YAML text

/// The shortest decimal that reads back as the same number, always recognisable as a floating-point one.
std::string shortest(double value)
{
  const double magnitude = std::abs(value);
  const bool ordinary = magnitude >= 1.0 && magnitude < 1e15;  // is written without an exponent
  char text[32];
  for (int digits = ordinary ? static_cast<int>(std::log10(magnitude)) + 1 : 1; digits <= 17; ++digits)
  {
    std::snprintf(text, sizeof(text), "%.*g", digits, value);
    if (std::strtod(text, nullptr) == value) break;
  }
  std::string number = text;
  const std::size_t exponent = number.find('e');
  if (number.find('.') == std::string::npos) number.insert(std::min(exponent, number.size()), ".0");  // YAML 1.1
  return number;
}

std::string quoted(const std::string& value)
{
  YAML::Emitter text;
  text << YAML::DoubleQuoted << value;
  return text.c_str();
}

Values toYaml(const dynamic_reconfigure::Config& config)
{
  Values values;
  for (const auto& p : config.bools)
    values.emplace_back(p.name, p.value != 0 ? "true" : "false");
  for (const auto& p : config.ints)
    values.emplace_back(p.name, std::to_string(p.value));
  for (const auto& p : config.doubles)
    values.emplace_back(p.name, shortest(p.value));
  for (const auto& p : config.strs)
    values.emplace_back(p.name, quoted(p.value));
  return values;
}

/// The file's text; empty if there is no such file.
std::string load(const std::string& path)
{
  if (access(path.c_str(), F_OK) != 0) return "";
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": not overwritten, for it cannot be read");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// The keys and values of a YAML map.
YAML::Node parse(const std::string& path, const std::string& text)
{
  try
  {
    const YAML::Node root = YAML::Load(text);
    if (root.IsMap() || root.IsNull()) return root;
  }
  catch (const YAML::Exception& e)
  {
    throw std::runtime_error(path + ": not overwritten, for it is no valid YAML: " + e.what());
  }
  throw std::runtime_error(path + ": not overwritten, for it is no map of parameters");
}

/// The length of the plain or quoted scalar at the beginning of `text`, without the blanks and the comment behind it.
std::size_t scalarLength(const std::string& text)
{
  if (text.empty() || text.front() == '#') return 0;
  const char quote = text.front();
  if (quote == '"' || quote == '\'')
  {
    std::size_t end = 1;
    while (end < text.size() && text[end] != quote)
      end += text[end] == '\\' ? 2 : 1;
    return std::min(end + 1, text.size());
  }
  return text.substr(0, text.find(" #")).find_last_not_of(" \t") + 1;
}

/// One line of the file with its value replaced, if it is the line of `name`.
bool editLine(std::string& line, const std::string& name, const std::string& value)
{
  if (line.compare(0, name.size(), name) != 0) return false;
  const std::size_t colon = line.find_first_not_of(" \t", name.size());
  if (colon == std::string::npos || line[colon] != ':') return false;
  const std::size_t begin = std::min(line.find_first_not_of(" \t", colon + 1), line.size());
  const std::string rest = line.substr(begin);
  const std::size_t end = begin + scalarLength(rest);
  const std::size_t comment = line.find_first_not_of(" \t", end);
  std::string edited = line.substr(0, colon + 1) + " " + value;
  // A comment stays in its column, if the value leaves it there.
  if (comment != std::string::npos)
    edited += std::string(comment > edited.size() ? comment - edited.size() : 1, ' ') + line.substr(comment);
  line = edited;
  return true;
}

/// The text with one value replaced or added.
std::string edit(const std::string& text, const std::string& name, const std::string& value)
{
  std::istringstream lines(text);
  std::string edited;
  bool found = false;
  for (std::string line; std::getline(lines, line); edited += line + "\n")
    found = (!found && editLine(line, name, value)) || found;
  return found ? edited : edited + name + ": " + value + "\n";
}

/// Throws unless `text` has the values to put, and all others as they were before.
void check(const std::string& path, const std::string& text, const YAML::Node& before, const Values& values)
{
  const YAML::Node after = parse(path, text);
  std::size_t expected = values.size();
  bool good = true;
  for (const auto& [name, value] : values)
    good = good && after[name] && after[name].IsScalar() && after[name].Scalar() == YAML::Load(value).Scalar();
  for (const auto& entry : before)
  {
    const auto& key = entry.first;
    const auto same = [&key](const auto& put) { return put.first == key.Scalar(); };
    if (std::any_of(values.begin(), values.end(), same)) continue;
    ++expected;
    good = good && after[key.Scalar()] && YAML::Dump(after[key.Scalar()]) == YAML::Dump(entry.second);
  }
  if (!good || after.size() != expected)
    throw std::runtime_error(path + ": not overwritten, for its parameters are not one \"name: value\" in each line");
}

[[noreturn]] void fail(const std::string& path, const char* what, int error)
{
  throw std::runtime_error(path + ": " + what + " failed: " + std::strerror(error));
}

/// Where a symbolic link leads to, so that the file is replaced and not the link.
std::string target(const std::string& path)
{
  char* resolved = realpath(path.c_str(), nullptr);
  const std::string real = resolved == nullptr ? path : resolved;
  std::free(resolved);
  return real;
}

void replaceFile(const std::string& path, const std::string& text)
{
  // In the same folder, or the rename could not be atomic.
  const std::string temporary = path + "." + std::to_string(getpid()) + ".tmp";
  const int fd = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd == -1) fail(path, "creating a temporary file beside it", errno);
  struct stat old;
  const bool keep_mode = stat(path.c_str(), &old) == 0;
  const bool written = write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                       (!keep_mode || fchmod(fd, old.st_mode & 07777) == 0) && fsync(fd) == 0;
  int error = errno;
  close(fd);
  if (written && rename(temporary.c_str(), path.c_str()) == 0) return;
  if (written) error = errno;
  unlink(temporary.c_str());
  fail(path, "writing", error);
}

}  // namespace

std::string editParams(const std::string& path, const std::string& text, const dynamic_reconfigure::Config& config)
{
  const Values values = toYaml(config);
  const YAML::Node before = parse(path, text);
  std::string edited = text;
  for (const auto& [name, value] : values)
    edited = edit(edited, name, value);
  check(path, edited, before, values);
  return edited;
}

void saveParams(const std::string& path, const dynamic_reconfigure::Config& config)
{
  replaceFile(target(path), editParams(path, load(path), config));
}

}  // namespace robot_vision
