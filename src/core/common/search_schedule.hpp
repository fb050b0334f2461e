#pragma once

#include <algorithm>
#include <opencv2/core.hpp>
#include <optional>

namespace robot_vision
{

/// Decides in which frames of a stream the whole image is searched for new objects; in the others only the tracks of
/// known objects are followed. All times are the frames' stamps in seconds.
class SearchSchedule
{
public:
  /// Begins a frame. Returns whether it has nothing to do with earlier ones: it is the first, or of another size than
  /// the last, or its time is not later.
  bool begin(double time, const cv::Size& size)
  {
    is_first_ = size != size_ || time <= time_;
    if (is_first_) searched_.reset();
    last_time_ = time_;
    time_ = time;
    size_ = size;
    return is_first_;
  }

  double time() const { return time_; }
  bool isFirst() const { return is_first_; }

  /// Whether the whole image must be searched in this frame: it would be too late in the next one, or an object that
  /// was seen since the last search should be in view and is not. A track has the time it was `seen` last and
  /// isInViewAt().
  template <class Tracks>
  bool isDue(double period, const Tracks& tracks) const
  {
    if (!searched_) return true;
    const double since = time_ - *searched_;
    if (since + (time_ - last_time_) > period) return true;
    const auto is_lost = [this](const auto& track)
    { return track.seen < time_ && track.seen >= *searched_ && track.isInViewAt(time_, size_); };
    return since >= minGap(period) && std::any_of(tracks.begin(), tracks.end(), is_lost);
  }

  /// The time that passes between two searches, even if objects are lost.
  static double minGap(double period) { return kMinGap * period; }

  /// The whole image is searched in this frame.
  void setSearched() { searched_ = time_; }

  /// A search is due in the next frame.
  void reset() { searched_.reset(); }

  /// A search of this frame begins in the background.
  void startBackground() { background_time_ = time_; }

  /// The search in the background has ended. Returns the time of the frame that was searched.
  double endBackground()
  {
    search_time_ = time_ - background_time_;
    return background_time_;
  }

  /// Forgets the tracks that were not seen for longer than the period, and for longer than it takes until a second
  /// search in the background tells how a new track moves.
  template <class Tracks>
  void forgetOld(double period, Tracks& tracks) const
  {
    const double oldest = time_ - std::max(period, kMinMemory * search_time_);
    const auto is_old = [oldest](const auto& track) { return track.seen < oldest; };
    tracks.erase(std::remove_if(tracks.begin(), tracks.end(), is_old), tracks.end());
  }

private:
  static constexpr double kMinGap = 0.2;     // periods between two searches
  static constexpr double kMinMemory = 2.5;  // durations of a search for which a lost track is kept at least

  cv::Size size_;                   // px, of the newest frame
  double time_ = 0.0;               // time of the newest frame
  double last_time_ = 0.0;          // time of the frame before
  bool is_first_ = true;            // whether nothing is known of earlier frames
  std::optional<double> searched_;  // the newest frame of which the whole image was searched
  double background_time_ = 0.0;    // the newest frame that was searched in the background
  double search_time_ = 0.0;        // duration of the last search in the background
};

}  // namespace robot_vision
