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
  cv::Point2d center;       // px, where the diagonals meet
  std::array<cv::Point2d, 4> corners;  // px: the upright tag's bottom left, bottom right, top right, top left one
};

/// Finds AprilTags with libapriltag (Wang, Olson: AprilTag 2: Efficient and robust fiducial detection, IROS 2016).
///
/// detect() searches the whole image. update() does so every now and then, so that a new tag is found within
/// max_search_period, and when a tag is lost; in the frames between it searches where the known tags should have moved
/// to. A tag is reported only where it was seen in this very frame. In a frame in which a tag comes into view it may
/// thus be missing, and for max_search_period at most; nothing else differs from detect(). A tag that is covered for a
/// moment is looked for in its place, too.
///
/// In the background such a search takes no time of update(), which goes on around the known tags. What the search
/// finds is looked for in the newest frame, the farther around the longer the search took, and reported there. A new
/// tag then appears later by the time of a search and a frame, and results depend on how fast the machine is: this is
/// for live images. The first frame, the first of another size, and that after time went back are searched by update()
/// itself, and so is every frame if max_search_period is 0.
///
/// With decimate 0 whole images are searched in full resolution, and the surroundings of a tag in as little as its
/// edges need. New tags of 64 px and more are then found within a fifth of max_search_period, as so often a fourth of
/// the resolution is searched.
///
/// Whatever has four corners may decode as a tag: a quarter of all patterns is within two bits of a tag16h5. Such false
/// tags have large margins in harsh light, and real tags small ones in the dark. The similarity tells them apart, as a
/// tag is black and white in all its cells and around them. In a tag16h5 one wrong bit is corrected at most, and so in
/// the three families with more than 10000 ids, whose tables would take gigabytes.
///
/// The corners of a tag that the border of the image cuts off are some px off. Two tags with the same id are both
/// reported.
///
/// A detector may be used by one thread at a time. update() shares the searches around tags among OpenCV's threads
/// (cv::setNumThreads), whose number changes no result. The library's own threads are not used, as they are not safe:
/// one that starts late may still work when its memory is freed. The destructor waits for a search in the background,
/// which at 3840x2160 may take seconds, as the library cannot be interrupted; see abandonSearch().
class TagDetector
{
public:
  /// Throws std::invalid_argument as validate() does.
  explicit TagDetector(const TagDetectorParams& params = TagDetectorParams());
  ~TagDetector();
  TagDetector(TagDetector&&) noexcept;
  TagDetector& operator=(TagDetector&&) noexcept;

  /// Other parameters from now on, also while a search is under way; tags remain known. Throws std::invalid_argument as
  /// validate() does.
  void configure(const TagDetectorParams& params);

  /// All tags in a single image, by family, id and place. Does not touch what update() follows. `image` is not
  /// modified, and not copied if it is mono8. Throws std::invalid_argument if it is not an image of `encoding` (see
  /// encoding.hpp), or has more than 8192 px in a row or a column.
  std::vector<Tag> detect(const cv::Mat& image, const std::string& encoding);

  /// The tags in the frame of `time_s` (s, of any clock), in the same order. An image of another size and time that
  /// goes back, or stands still, make it forget all tags. Throws as detect() does, and for a time that is not finite.
  std::vector<Tag> update(double time_s, const cv::Mat& image, const std::string& encoding);

  /// Waits for a search in the background, so that the next update() has what it has found: for recordings, and for
  /// results that do not depend on how fast the machine is.
  void waitForSearch() const;

  /// Whether update() had to search a whole image itself the last time, as no thread could be started for it.
  bool lacksThreads() const;

  /// From now on the destructor does not wait for a search in the background, which goes on to its end or that of the
  /// process: for a process that is about to end. This library must stay loaded. May be called by any thread.
  void abandonSearch();

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
