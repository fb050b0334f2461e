#include "tag_dictionary.hpp"

#include <algorithm>
#include <utility>

#include "core/common/shared_instance.hpp"
#include "robot_vision/tags/detection/tag_families.hpp"

namespace robot_vision
{
namespace
{

// The library's table takes 48 bytes for each word that it corrects: with two bits of the largest families 4 GB.
constexpr int kManyIds = 10000;
constexpr int kSmallDistance = 5;  // between tags, at which most patterns are near one

int mostCorrected(const std::string& family)
{
  const TagFamily& facts = tagFamily(family);
  return facts.ids > kManyIds || facts.distance <= kSmallDistance ? 1 : 2;
}

DetectorPtr createDetector(void (*destroy)(apriltag_detector_t*))
{
  DetectorPtr detector(apriltag_detector_create(), destroy);
  detector->nthreads = 1;  // the library's own are not safe: one that starts late may find its memory given back
  return detector;
}

/// A detector gives back the tables of the families that it has, and these are not its own.
void destroyBorrower(apriltag_detector_t* detector)
{
  zarray_clear(detector->tag_families);
  apriltag_detector_destroy(detector);
}

}  // namespace

TagDictionary::TagDictionary(const std::vector<std::string>& families, int max_hamming)
  : tables_(createDetector(apriltag_detector_destroy))
{
  for (const std::string& name : families)
  {
    FamilyPtr record = makeFamily(name);
    apriltag_detector_add_family_bits(tables_.get(), record.get(), std::min(max_hamming, mostCorrected(name)));
    TagPattern pattern(*record);
    families_.push_back({std::move(record), std::move(pattern)});
  }
}

std::shared_ptr<const TagDictionary> TagDictionary::of(const std::vector<std::string>& families, int max_hamming)
{
  return sharedInstance<const TagDictionary>(families, max_hamming);
}

DetectorPtr TagDictionary::makeDetector() const
{
  DetectorPtr detector = createDetector(destroyBorrower);
  for (const Family& family : families_)
    apriltag_detector_add_family(detector.get(), family.record.get());  // which has its table
  return detector;
}

const TagPattern& TagDictionary::patternOf(const apriltag_family_t* record) const
{
  return std::find_if(families_.begin(), families_.end(),
                      [record](const Family& family) { return family.record.get() == record; })
      ->pattern;
}

}  // namespace robot_vision
