#include "yaml_text.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>

namespace robot_vision
{
namespace
{

/// The length of the plain or quoted scalar at the beginning of `text`, without the blanks and the comment after it.
std::size_t scalarLength(const std::string& text)
{
  if (text.empty() || text.front() == '#') return 0;
  const char quote = text.front();
  if (quote == '"' || quote == '\'')
  {
    // What stands for a quote inside: \" or ''.
    const char escape = quote == '"' ? '\\' : '\'';
    std::size_t end = 1;
    while (end < text.size() && (text[end] != quote || (escape == quote && text[end + 1] == quote)))
      end += text[end] == escape ? 2 : 1;
    return std::min(end + 1, text.size());
  }
  return text.substr(0, text.find(" #")).find_last_not_of(" \t") + 1;
}

/// Replaces the value in a line if it is the line of `name`; returns false otherwise.
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
  // A comment stays in its column if the new value is not too long.
  if (comment != std::string::npos)
    edited += std::string(comment > edited.size() ? comment - edited.size() : 1, ' ') + line.substr(comment);
  line = edited;
  return true;
}

struct Line
{
  std::string text;
  std::string end;  // LF, or CR and LF
};

std::vector<Line> linesOf(const std::string& text)
{
  std::vector<Line> lines;
  for (std::size_t begin = 0; begin < text.size();)
  {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const bool has_cr = end > begin && text[end - 1] == '\r';
    lines.push_back({text.substr(begin, end - begin - (has_cr ? 1 : 0)), has_cr ? "\r\n" : "\n"});
    begin = end + 1;
  }
  return lines;
}

/// A new line with the same line ending as the first one.
Line added(const std::vector<Line>& lines, const std::string& text)
{
  return {text, lines.empty() ? "\n" : lines.front().end};
}

std::string joined(const std::vector<Line>& lines)
{
  std::string text;
  for (const Line& line : lines)
    text += line.text + line.end;
  return text;
}

std::size_t indentOf(const std::string& line)
{
  return std::min(line.find_first_not_of(' '), line.size());
}

/// The index after the last line that belongs to the key in line `begin`.
std::size_t blockEnd(const std::vector<Line>& lines, std::size_t begin)
{
  std::size_t end = begin + 1;
  for (std::size_t i = end; i < lines.size(); ++i)
  {
    const std::string& line = lines[i].text;
    if (!line.empty() && line[0] != ' ' && line[0] != '#') break;
    if (indentOf(line) > 0 && indentOf(line) < line.size()) end = i + 1;
  }
  return end;
}

/// The column of the entries of a map, whose header is in line `header`, and which ends before `end`.
std::size_t indentOfEntries(const std::vector<Line>& lines, std::size_t header, std::size_t end)
{
  for (std::size_t i = header + 1; i < end; ++i)
  {
    const std::size_t indent = indentOf(lines[i].text);
    if (indent < lines[i].text.size() && lines[i].text[indent] != '#') return indent;
  }
  return 2;
}

/// A value as text. Quoted values stay quoted, because without quotes they could have another type.
std::string dump(const YAML::Node& value)
{
  YAML::Emitter text;
  if (value.IsScalar() && value.Tag() == "!") text << YAML::DoubleQuoted;
  text << value;
  return text.c_str();
}

/// Replaces a map in flow style, {a: 1}, by a block of lines.
void unfold(std::vector<Line>& lines, std::size_t header, const std::string& map)
{
  std::string& line = lines[header].text;
  const YAML::Node entries = YAML::Load(line)[map];
  if (!entries.IsMap()) return;
  std::vector<Line> block;
  for (const auto& entry : entries)
    block.push_back(added(lines, "  " + dump(entry.first) + ": " + dump(entry.second)));
  editLine(line, map, "");
  line.erase(line.find_last_not_of(' ') + 1);
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(header) + 1, block.begin(), block.end());
}

}  // namespace

std::string editYaml(const std::string& text, const std::string& name, const std::string& value)
{
  std::vector<Line> lines = linesOf(text);
  const auto edited = [&](Line& line) { return editLine(line.text, name, value); };
  if (std::none_of(lines.begin(), lines.end(), edited)) lines.push_back(added(lines, name + ": " + value));
  return joined(lines);
}

std::string editYamlMap(const std::string& text, const std::string& map, const YamlValues& values)
{
  std::vector<Line> lines = linesOf(text);
  const auto is_header = [&map](Line line) { return editLine(line.text, map, ""); };
  const auto header = static_cast<std::size_t>(std::find_if(lines.begin(), lines.end(), is_header) - lines.begin());
  if (header == lines.size()) lines.push_back(added(lines, map + ":"));
  if (blockEnd(lines, header) == header + 1) unfold(lines, header, map);

  const std::size_t end = blockEnd(lines, header);
  const std::size_t indent = indentOfEntries(lines, header, end);
  std::vector<Line> more;
  for (const auto& [name, value] : values)
  {
    bool found = false;
    for (std::size_t i = header + 1; i < end && !found; ++i)
    {
      std::string& line = lines[i].text;
      std::string entry = line.substr(indentOf(line));
      found = indentOf(line) == indent && editLine(entry, name, value);
      if (found) line = std::string(indent, ' ') + entry;
    }
    if (!found) more.push_back(added(lines, std::string(indent, ' ') + name + ": " + value));
  }
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(end), more.begin(), more.end());
  return joined(lines);
}

}  // namespace robot_vision
