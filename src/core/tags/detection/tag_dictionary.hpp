#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tag_library.hpp"
#include "tag_pattern.hpp"

namespace robot_vision
{

using DetectorPtr = std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)>;

/// The tags of some families, with the library's large tables of them. Never changes, so that detectors in several
/// threads can share one.
class TagDictionary
{
public:
  /// The names and the number must be valid.
  TagDictionary(const std::vector<std::string>& families, int max_hamming);

  /// The one that others have of these, or a new one, as it takes a while to make its tables. Thread-safe.
  static std::shared_ptr<const TagDictionary> of(const std::vector<std::string>& families, int max_hamming);

  /// A detector of these tags, for one thread at a time. The dictionary must outlive it.
  DetectorPtr makeDetector() const;

  /// What the tags of a detection's family look like.
  const TagPattern& patternOf(const apriltag_family_t* record) const;

private:
  struct Family
  {
    FamilyPtr record;
    TagPattern pattern;
  };

  std::vector<Family> families_;  // must outlive the tables in them
  DetectorPtr tables_;            // whose destructor frees the tables
};

}  // namespace robot_vision
