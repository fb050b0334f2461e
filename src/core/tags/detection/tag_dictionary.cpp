#include "tag_dictionary.hpp"

#include <algorithm>
#include <utility>

#include "robot_vision/common/shared_instance.hpp"
#include "robot_vision/tags/detection/tag_families.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxIds = 10000;   // for two bits: with 48 bytes for each corrected word, larger tables could have 4 GB
constexpr int kMinDistance = 6;  // bits between any two tags, for two bits: or else most patterns would be near a tag

/// How many wrong bits are corrected at most.
int maxCorrected(const std::string& family)
{
  const TagFamily& facts = tagFamily(family);
  return facts.ids > kMaxIds || facts.distance < kMinDistance ? 1 : 2;
}

DetectorPtr createDetector(void (*destroy)(apriltag_detector_t*))
{
  DetectorPtr detector(apriltag_detector_create(), destroy);
  detector->nthreads = 1;  // its threads are not safe: one that starts late may find its memory freed
  return detector;
}

/// Destroys a detector without the tables of its families, which belong to the dictionary.
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
    apriltag_detector_add_family_bits(tables_.get(), record.get(), std::min(max_hamming, maxCorrected(name)));
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
    apriltag_detector_add_family(detector.get(), family.record.get());  // it has its table already
  return detector;
}

const TagPattern& TagDictionary::patternOf(const apriltag_family_t* record) const
{
  return std::find_if(families_.begin(), families_.end(),
                      [record](const Family& family) { return family.record.get() == record; })
      ->pattern;
}

}  // namespace robot_vision
