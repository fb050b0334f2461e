#include "edge_hysteresis.hpp"

namespace robot_vision
{
namespace
{

/// The runs of ones in `candidates` that contain a bit of `seeds`. All seeds must be candidates.
BitWord fillRuns(BitWord seeds, BitWord candidates)
{
  // The carry of the addition goes from the lowest seed of a run to the end of the run.
  BitWord filled = (((seeds + candidates) ^ candidates) | seeds) & candidates;
  BitWord path = candidates;
  for (int step = 1; step < kWordBits; step *= 2)
  {
    filled |= path & filled >> step;
    path &= path >> step;
  }
  return filled;
}

}  // namespace

void EdgeHysteresis::reset(cv::Size size)
{
  if (size == size_) return;
  size_ = size;
  words_ = static_cast<std::size_t>((size.width + kWordBits - 1) / kWordBits);
  stride_ = words_ + 2;
  candidates_.assign(stride_ * static_cast<std::size_t>(size.height + 2), 0);
  edges_ = candidates_;
}

void EdgeHysteresis::setRow(int y, const std::uint8_t* marks)
{
  kernels<BitKernels>().split_marks(marks, static_cast<int>(words_), &candidates_[at(y)], &edges_[at(y)]);
}

/// Makes edges of the candidates of a word that are connected to edges of the word or its neighbours. Returns whether
/// there were any.
bool EdgeHysteresis::spread(std::size_t word)
{
  const BitWord candidates = candidates_[word];
  const BitWord before = edges_[word];
  BitWord near = before;
  for (const std::size_t i : {word - stride_, word, word + stride_})
    near |= edges_[i] | edges_[i] << 1 | edges_[i] >> 1 | edges_[i - 1] >> (kWordBits - 1) |
            edges_[i + 1] << (kWordBits - 1);
  near &= candidates;
  if (near == before) return false;
  edges_[word] = fillRuns(near, candidates);
  return edges_[word] != before;
}

void EdgeHysteresis::connect()
{
  for (int y = 0; y < size_.height; ++y)
  {
    const std::size_t begin = at(y);
    for (std::size_t i = begin; i < begin + words_; ++i)
      for (std::size_t word = i; isOpen(word) && spread(word);)
        --word;  // the new edges may continue in the word before; the margin before the row has no candidates
  }
  for (int y = size_.height; y-- > 0;)
    for (std::size_t i = at(y); i < at(y) + words_; ++i)
      if (isOpen(i) && spread(i)) gained_.push_back(i);
  spreadFromList();
}

void EdgeHysteresis::spreadFromList()
{
  while (!gained_.empty())
  {
    const std::size_t word = gained_.back();
    gained_.pop_back();
    for (const std::size_t middle : {word - stride_, word, word + stride_})
      for (const std::size_t i : {middle - 1, middle, middle + 1})
        if (isOpen(i) && spread(i)) gained_.push_back(i);
  }
}

void EdgeHysteresis::write(cv::Mat& edges) const
{
  edges.create(size_, CV_8UC1);
  for (int y = 0; y < size_.height; ++y)
    kernels<BitKernels>().spread_bits(&edges_[at(y)], size_.width, edges.ptr(y));
}

}  // namespace robot_vision
