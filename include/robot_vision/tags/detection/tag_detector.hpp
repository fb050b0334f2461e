#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"

namespace robot_vision
{

struct TagDetectorParams
{
  std::vector<std::string> families = {"tag36h11"};
  double decimate = 0.0;
  double blur = 0.0;
  bool refine_edges = true;
  int max_hamming = 2;
  double min_margin = 0.0;
  double min_similarity = 0.8;
  double max_search_period = 0.5;
  bool background = false;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("families", &TagDetectorParams::families, Anything{}, "",
          "that are looked for, each once; see tag_families.hpp");
    visit("decimate", &TagDetectorParams::decimate, Range{0, 10}, "",
          "pixels between those that are looked at for edges: 1 (all), 1.5, 2, 3, ...; 0: by the tags' size");
    visit("blur", &TagDetectorParams::blur, Range{-5, 5}, "px", "sigma of a blur of those before; below 0 it sharpens");
    visit("refine_edges", &TagDetectorParams::refine_edges, Anything{}, "",
          "move the edges to where the full image changes most");
    visit("max_hamming", &TagDetectorParams::max_hamming, Range{0, 2}, "",
          "wrong bits that are corrected; of tag16h5 and the families with more than 10000 ids one at most");
    visit("min_margin", &TagDetectorParams::min_margin, Range{0, 255}, "gray levels", "least decision margin");
    visit("min_similarity", &TagDetectorParams::min_similarity, Range{-1, 1}, "",
          "least correlation with what the tag looks like, which keeps ghosts out");
    visit("max_search_period", &TagDetectorParams::max_search_period, Range{0, 60}, "s",
          "time between searches of a whole image, which find new tags; 0: every frame is searched whole");
    visit("background", &TagDetectorParams::background, Anything{}, "",
          "search whole images in a thread of its own, while update() goes on");
  }
};

/// Throws std::invalid_argument naming the first parameter out of range, its value and the range.
void validate(const TagDetectorParams& params);

/// A tag in an image.
struct Tag
{
  std::string family;
  int id = 0;
  int hamming = 0;          // wrong bits that were corrected
  double margin = 0.0;      // gray levels, mean distance of the bits from the threshold between black and white
  double similarity = 0.0;  // correlation of the image with the tag's cells and borders, at most 1
  cv::Point2d center;       // px, the intersection of the diagonals
  std::array<cv::Point2d, 4> corners;  // px: bottom left, bottom right, top right, top left of the upright tag
};

/// Finds AprilTags with libapriltag (Wang, Olson: AprilTag 2: Efficient and robust fiducial detection, IROS 2016).
///
/// detect() searches the whole image. update() does so when a tag is lost and otherwise as often as is needed to find a
/// new tag within max_search_period; in the frames between it searches only around the places to which the known tags
/// should have moved. A tag is reported only where it was seen in this very frame. The results differ from those of
/// detect() only in that a new tag may be missing for up to max_search_period after it comes into view. A tag that is
/// covered for a moment is also looked for in its last place.
///
/// A search of the whole image in the background takes no time of update(), which goes on around the known tags. The
/// tags that the search finds are then looked for in the newest frame, in an area that grows with the time the search
/// took, and are reported there. A new tag thus appears later by the time of a search and a frame, and the results
/// depend on the speed of the machine, so this mode is meant for live images. update() itself searches the first frame,
/// the first frame of another size and the first one after time went back, and every frame if max_search_period is 0.
///
/// With decimate 0, whole images are searched in full resolution, and the surroundings of a tag in the lowest
/// resolution that its edges allow. A fourth of the resolution is searched five times as often, so that new tags of 64
/// px and more are found within a fifth of max_search_period.
///
/// Anything with four corners may decode as a tag: a quarter of all patterns is within two bits of a tag16h5. Such
/// false detections have large margins in harsh light, and real tags have small ones in the dark. The similarity tells
/// them apart, because a real tag is black and white in all its cells and around them. At most one wrong bit is
/// corrected in tag16h5, and in the three families with more than 10000 ids, whose tables would otherwise take
/// gigabytes.
///
/// The corners of a tag that the image's border cuts off have errors of some px. Two tags with the same id are both
/// reported.
///
/// A detector may be used by one thread at a time. update() shares the searches around tags among OpenCV's threads
/// (cv::setNumThreads), whose number does not change the results. The library's own threads are not used, because a
/// thread that starts late may still work when its memory is released. The destructor waits for a search in the
/// background, which may take seconds at 3840x2160, because the library cannot be interrupted; see abandonSearch().
class TagDetector
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit TagDetector(const TagDetectorParams& params = TagDetectorParams());
  ~TagDetector();
  TagDetector(TagDetector&&) noexcept;
  TagDetector& operator=(TagDetector&&) noexcept;

  /// Changes the parameters, also while a search is running; known tags remain known. Throws std::invalid_argument as
  /// validate() does.
  void configure(const TagDetectorParams& params);

  /// All tags of a single image, sorted by family, id and position. The state of update() is neither used nor changed.
  /// `image` is not modified, and not copied if it is mono8. Throws std::invalid_argument if it is not an image of
  /// `encoding` (see encoding.hpp), or has more than 8192 px in a row or a column.
  std::vector<Tag> detect(const cv::Mat& image, const std::string& encoding);

  /// The tags in the frame at `time_s` (s, of any clock), in the same order. The known tags are forgotten when the size
  /// of the image changes and when the time does not increase. Throws as detect() does, and for a time that is not
  /// finite.
  std::vector<Tag> update(double time_s, const cv::Mat& image, const std::string& encoding);

  /// Waits for a search in the background, so that the next update() can use its results. Recordings need this, and
  /// callers whose results must not depend on the speed of the machine.
  void waitForSearch() const;

  /// True if the last update() had to search the whole image itself, because no thread could be started for it.
  bool lacksThreads() const;

  /// After this call the destructor no longer waits for a search in the background, which then goes on to its end or
  /// that of the process. It is meant for a process that is about to exit; this library must stay loaded. Any thread
  /// may call it.
  void abandonSearch();

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
