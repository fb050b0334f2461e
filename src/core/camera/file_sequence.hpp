#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "robot_vision/camera/frame_source.hpp"

namespace robot_vision
{

/// The files of a source one after the other, some of which may be damaged. `Files` is what a frame is read from.
template <class Files>
class FileSequence
{
public:
  /// `path` is where they were found, for messages.
  FileSequence(std::string path, std::vector<Files> all) : path_(std::move(path)), all_(std::move(all)) {}

  const std::vector<Files>& all() const { return all_; }
  void rewind() { next_ = 0; }

  /// Has `read_one` fill `frame` from the next ones, and numbers it. Throws std::invalid_argument where that throws
  /// SourceError, as the next ones may be good, and SourceError after as many failures in a row as there are files.
  template <class ReadOne>
  ReadResult read(Frame& frame, const ReadOne& read_one)
  {
    if (failed_in_a_row_ == all_.size()) throw SourceError(path_ + ": none of its images can be read");
    if (next_ == all_.size()) return ReadResult::kEnd;
    const Files& files = all_[next_++];
    try
    {
      read_one(files);
    }
    catch (const SourceError& e)
    {
      ++failed_in_a_row_;
      throw std::invalid_argument(e.what());
    }
    failed_in_a_row_ = 0;
    frame.sequence = sequence_++;
    return ReadResult::kFrame;
  }

private:
  std::string path_;
  std::vector<Files> all_;
  std::size_t next_ = 0;
  std::size_t failed_in_a_row_ = 0;
  std::int64_t sequence_ = 0;
};

}  // namespace robot_vision
