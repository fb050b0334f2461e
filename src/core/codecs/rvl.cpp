#include "rvl.hpp"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>

#include "robot_vision/image/jpeg.hpp"

namespace robot_vision
{
namespace
{

// Numbers are written in groups of 3 bits, the lowest first. A group and the bit that says whether more follow are 4
// bits of a word of 32 bits, which is filled from its highest bits, and is in the byte order of the machine, because
// the standard transport copies it from memory.
using Word = std::uint32_t;
constexpr int kGroupBits = 3;
constexpr Word kGroupMask = 7;
constexpr Word kMore = 8;
constexpr int kGroupsOfWord = 8;
constexpr int kMaxNumberBits = 32;
constexpr std::int64_t kMaxDepth = 65535;

[[noreturn]] void refuse(std::size_t size, const std::string& reason)
{
  throw std::invalid_argument("RVL of " + std::to_string(size) + " bytes " + reason);
}

class NumberWriter
{
public:
  explicit NumberWriter(std::vector<std::uint8_t>& out) : out_(out) {}

  void write(Word number)
  {
    do
    {
      const Word rest = number >> kGroupBits;
      word_ = word_ << 4 | (number & kGroupMask) | (rest != 0 ? kMore : 0);
      if (++groups_ == kGroupsOfWord) flush();
      number = rest;
    } while (number != 0);
  }

  /// Writes the last word, if it has any groups.
  void finish()
  {
    if (groups_ == 0) return;
    word_ <<= 4 * (kGroupsOfWord - groups_);
    flush();
  }

private:
  void flush()
  {
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&word_);
    out_.insert(out_.end(), bytes, bytes + sizeof(word_));
    word_ = 0;
    groups_ = 0;
  }

  std::vector<std::uint8_t>& out_;
  Word word_ = 0;
  int groups_ = 0;  // in the word
};

class NumberReader
{
public:
  NumberReader(const unsigned char* data, std::size_t size, std::size_t begin) : data_(data), size_(size), at_(begin) {}

  /// The next number. Throws std::invalid_argument at the end of the stream.
  Word read()
  {
    Word number = 0, group = 0;
    int bits = 0;
    do
    {
      if (bits >= kMaxNumberBits) refuse(size_, "is damaged");
      group = nextGroup();
      number |= (group & kGroupMask) << bits;
      bits += kGroupBits;
    } while ((group & kMore) != 0);
    return number;
  }

private:
  Word nextGroup()
  {
    if (groups_ == 0)
    {
      if (size_ - at_ < sizeof(word_)) refuse(size_, "is truncated");
      std::memcpy(&word_, data_ + at_, sizeof(word_));
      at_ += sizeof(word_);
      groups_ = kGroupsOfWord;
    }
    --groups_;
    return word_ >> (4 * groups_) & (kGroupMask | kMore);
  }

  const unsigned char* data_;
  std::size_t size_;
  std::size_t at_;
  Word word_ = 0;
  int groups_ = 0;  // of the word that are not read yet
};

/// A difference as a number that is small if it is: 0, -1, 1, -2 become 0, 1, 2, 3.
Word folded(std::int32_t difference)
{
  return static_cast<Word>(difference) << 1 ^ (difference < 0 ? ~Word{0} : 0);
}

std::int64_t unfolded(Word number)
{
  const std::int64_t half = number >> 1;
  return (number & 1) != 0 ? -half - 1 : half;
}

/// Reads a number of pixels, of which there are at most `left` more.
Word readRun(NumberReader& reader, std::size_t left, std::size_t size)
{
  const Word run = reader.read();
  if (run > left) refuse(size, "is damaged");
  return run;
}

}  // namespace

void encodeRvl(const cv::Mat& image, std::vector<std::uint8_t>& out)
{
  const cv::Mat packed = image.isContinuous() ? image : image.clone();
  const Word sides[] = {static_cast<Word>(packed.cols), static_cast<Word>(packed.rows)};
  const auto* const head = reinterpret_cast<const std::uint8_t*>(sides);
  out.insert(out.end(), head, head + sizeof(sides));
  NumberWriter writer(out);
  const auto* at = packed.ptr<std::uint16_t>();
  const auto* const end = at + packed.total();
  std::int32_t previous = 0;
  while (at != end)
  {
    const auto* const seen = std::find_if(at, end, [](std::uint16_t z) { return z != 0; });
    const auto* const hole = std::find(seen, end, std::uint16_t{0});
    writer.write(static_cast<Word>(seen - at));
    writer.write(static_cast<Word>(hole - seen));
    for (at = seen; at != hole; ++at)
    {
      writer.write(folded(*at - previous));
      previous = *at;
    }
  }
  writer.finish();
}

cv::Mat decodeRvl(const unsigned char* data, std::size_t size)
{
  Word sides[2] = {};
  if (size < sizeof(sides)) refuse(size, "has no whole header");
  std::memcpy(sides, data, sizeof(sides));
  if (sides[0] == 0 || sides[1] == 0) refuse(size, "has no pixels");
  requireDecodableSize("RVL of " + std::to_string(size) + " bytes ", sides[0], sides[1]);
  cv::Mat image(static_cast<int>(sides[1]), static_cast<int>(sides[0]), CV_16UC1, cv::Scalar(0));
  NumberReader reader(data, size, sizeof(sides));
  auto* at = image.ptr<std::uint16_t>();
  std::size_t left = image.total();
  std::int64_t depth = 0;
  while (left > 0)
  {
    const Word holes = readRun(reader, left, size);
    left -= holes;
    at += holes;
    const Word seen = readRun(reader, left, size);
    left -= seen;
    for (const auto* const end = at + seen; at != end; ++at)
    {
      depth += unfolded(reader.read());
      if (depth < 0 || depth > kMaxDepth) refuse(size, "is damaged");
      *at = static_cast<std::uint16_t>(depth);
    }
  }
  return image;
}

}  // namespace robot_vision
