#include "yaml_text.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <sstream>

namespace robot_vision
{
namespace
{

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

std::vector<std::string> linesOf(const std::string& text)
{
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);)
    lines.push_back(line);
  return lines;
}

std::string joined(const std::vector<std::string>& lines)
{
  std::string text;
  for (const std::string& line : lines)
    text += line + "\n";
  return text;
}

std::size_t indentOf(const std::string& line)
{
  return std::min(line.find_first_not_of(' '), line.size());
}

/// The end of the lines that belong to the key in line `begin`.
std::size_t blockEnd(const std::vector<std::string>& lines, std::size_t begin)
{
  std::size_t end = begin + 1;
  for (std::size_t i = end; i < lines.size() && (lines[i].empty() || lines[i][0] == ' ' || lines[i][0] == '#'); ++i)
    if (indentOf(lines[i]) > 0 && indentOf(lines[i]) < lines[i].size()) end = i + 1;
  return end;
}

/// A value as it was: what was in quotes would be another type without them.
std::string dump(const YAML::Node& value)
{
  YAML::Emitter text;
  if (value.IsScalar() && value.Tag() == "!") text << YAML::DoubleQuoted;
  text << value;
  return text.c_str();
}

/// Writes a map that is in one line, {a: 1}, as a block of lines.
void unfold(std::vector<std::string>& lines, std::size_t header, const std::string& map)
{
  const YAML::Node entries = YAML::Load(lines[header])[map];
  if (!entries.IsMap()) return;
  std::vector<std::string> block;
  for (const auto& entry : entries)
    block.push_back("  " + dump(entry.first) + ": " + dump(entry.second));
  editLine(lines[header], map, "");
  lines[header].erase(lines[header].find_last_not_of(' ') + 1);
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(header) + 1, block.begin(), block.end());
}

}  // namespace

std::string editYaml(const std::string& text, const std::string& name, const std::string& value)
{
  std::vector<std::string> lines = linesOf(text);
  const auto edited = [&](std::string& line) { return editLine(line, name, value); };
  if (std::none_of(lines.begin(), lines.end(), edited)) lines.push_back(name + ": " + value);
  return joined(lines);
}

std::string editYamlMap(const std::string& text, const std::string& map, const YamlValues& values)
{
  std::vector<std::string> lines = linesOf(text);
  const auto is_header = [&map](std::string line) { return editLine(line, map, ""); };
  const auto header = static_cast<std::size_t>(std::find_if(lines.begin(), lines.end(), is_header) - lines.begin());
  if (header == lines.size()) lines.push_back(map + ":");
  if (blockEnd(lines, header) == header + 1) unfold(lines, header, map);

  const std::size_t end = blockEnd(lines, header);
  const std::size_t indent = end > header + 1 ? indentOf(lines[header + 1]) : 2;
  std::vector<std::string> added;
  for (const auto& [name, value] : values)
  {
    bool found = false;
    for (std::size_t i = header + 1; i < end && !found; ++i)
    {
      std::string entry = lines[i].substr(indentOf(lines[i]));
      found = indentOf(lines[i]) == indent && editLine(entry, name, value);
      if (found) lines[i] = std::string(indent, ' ') + entry;
    }
    if (!found) added.push_back(std::string(indent, ' ') + name + ": " + value);
  }
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(end), added.begin(), added.end());
  return joined(lines);
}

}  // namespace robot_vision
