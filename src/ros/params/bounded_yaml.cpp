#include "bounded_yaml.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <map>
#include <sstream>
#include <utility>
#include <vector>

namespace robot_vision
{
namespace
{

/// Counts the values and levels of a document and throws when there are too many.
class Limits : public YAML::EventHandler
{
public:
  void OnDocumentStart(const YAML::Mark& /*mark*/) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { scalar(mark, anchor); }
  void OnScalar(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                const std::string& /*value*/) override
  {
    scalar(mark, anchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override
  {
    begin(mark, anchor);
  }
  void OnSequenceEnd() override { end(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override
  {
    begin(mark, anchor);
  }
  void OnMapEnd() override { end(); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override
  {
    const auto target = values_of_.find(anchor);
    if (target == values_of_.end()) throw YAML::ParserException(mark, "an alias of what it is part of");
    add(mark, target->second);
  }

private:
  void scalar(const YAML::Mark& mark, YAML::anchor_t anchor)
  {
    begin(mark, anchor);
    end();
  }

  void begin(const YAML::Mark& mark, YAML::anchor_t anchor)
  {
    open_.emplace_back(anchor, values_);
    if (open_.size() > kMaxYamlDepth)
      throw YAML::ParserException(mark, "nested deeper than " + std::to_string(kMaxYamlDepth) + " levels");
    add(mark, 1);
  }

  void end()
  {
    const auto& [anchor, before] = open_.back();
    values_of_[anchor] = values_ - before;
    open_.pop_back();
  }

  void add(const YAML::Mark& mark, std::size_t values)
  {
    values_ += values;
    if (values_ > kMaxYamlValues)
      throw YAML::ParserException(mark, "more than " + std::to_string(kMaxYamlValues) + " values");
  }

  std::vector<std::pair<YAML::anchor_t, std::size_t>> open_;  // open nodes with the number of values before each
  std::size_t values_ = 0;                                    // so far
  std::map<YAML::anchor_t, std::size_t> values_of_;           // anchor -> values of the node, for closed nodes
};

}  // namespace

void requireBoundedYaml(const std::string& text)
{
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  Limits limits;
  parser.HandleNextDocument(limits);
}

}  // namespace robot_vision
