#include "median_kernels.hpp"

#include <utility>

#include "core/simd/vectors.hpp"

namespace robot_vision
{
namespace
{

#ifdef ROBOT_VISION_VECTORS

constexpr int kMaxSize = 11;
constexpr int kBytes = sizeof(Simd::Vector);

/// Numbers of values, from the least value to the greatest.
template <int kCount>
struct Order
{
  int numbers[kCount] = {};
  int count = 0;

  constexpr void add(int number) { numbers[count++] = number; }
};

/// Puts the lesser of two values in the place of the first, and the greater in that of the second, as far as needed.
struct Comparator
{
  int first = 0;
  int second = 0;
  bool needs_lesser = true;
  bool needs_greater = true;
};

/// A network that sorts, or finds the median of, `kCount` values.
template <int kCount>
class Network
{
public:
  static constexpr int kMaxComparators = kCount * 12;  // comparators

  Comparator comparators[kMaxComparators] = {};
  int count = 0;
  Order<kCount> order = {};  // of the places, after the comparators

  /// Merges sorted lists of places, which are of one length, two shortest ones at a time, until there is one. The
  /// merged one is never shorter than any that is left.
  template <int kLists>
  constexpr void mergeAll(Order<kCount> (&lists)[kLists])
  {
    for (int left = kLists; left > 1; --left)
    {
      const Order<kCount> merged = merge(lists[0], lists[1]);
      for (int i = 2; i < left; ++i)
        lists[i - 2] = lists[i];
      lists[left - 2] = merged;
    }
    order = lists[0];
  }

  /// Leaves out what the value in the middle does not depend on.
  constexpr void keepMedian()
  {
    bool needed[kCount] = {};
    needed[order.numbers[kCount / 2]] = true;
    int begin = count;
    for (int i = count; i-- > 0;)
    {
      Comparator one = comparators[i];
      one.needs_lesser = needed[one.first];
      one.needs_greater = needed[one.second];
      if (!one.needs_lesser && !one.needs_greater) continue;
      needed[one.first] = needed[one.second] = true;
      comparators[--begin] = one;
    }
    for (int i = begin; i < count; ++i)
      comparators[i - begin] = comparators[i];
    count -= begin;
  }

private:
  constexpr void compare(int first, int second)
  {
    comparators[count].first = first;
    comparators[count].second = second;
    ++count;
  }

  static constexpr Order<kCount> everySecond(const Order<kCount>& all, int begin)
  {
    Order<kCount> some;
    for (int i = begin; i < all.count; i += 2)
      some.add(all.numbers[i]);
    return some;
  }

  /// Batcher's merge of two sorted lists of any lengths.
  constexpr Order<kCount> merge(const Order<kCount>& a, const Order<kCount>& b)
  {
    if (a.count == 0) return b;
    if (b.count == 0) return a;
    Order<kCount> merged;
    if (a.count == 1 && b.count == 1)
    {
      compare(a.numbers[0], b.numbers[0]);
      merged.add(a.numbers[0]);
      merged.add(b.numbers[0]);
      return merged;
    }
    const Order<kCount> even = merge(everySecond(a, 0), everySecond(b, 0));
    const Order<kCount> odd = merge(everySecond(a, 1), everySecond(b, 1));
    merged.add(even.numbers[0]);
    for (int i = 0; i < odd.count || i + 1 < even.count; ++i)
    {
      if (i < odd.count && i + 1 < even.count) compare(odd.numbers[i], even.numbers[i + 1]);
      if (i < odd.count) merged.add(odd.numbers[i]);
      if (i + 1 < even.count) merged.add(even.numbers[i + 1]);
    }
    return merged;
  }
};

template <int kSize>
constexpr Network<kSize> sortingNetwork()
{
  Order<kSize> single[kSize];
  for (int i = 0; i < kSize; ++i)
    single[i].add(i);
  Network<kSize> network;
  network.mergeAll(single);
  return network;
}

/// Of a window whose columns are sorted; column x has the places from x * kSize on.
template <int kSize>
constexpr Network<kSize * kSize> medianNetwork()
{
  Order<kSize * kSize> columns[kSize];
  for (int i = 0; i < kSize * kSize; ++i)
    columns[i / kSize].add(i);
  Network<kSize * kSize> network;
  network.mergeAll(columns);
  network.keepMedian();
  return network;
}

template <int kSize>
struct Networks
{
  static constexpr auto kColumn = sortingNetwork<kSize>();
  static constexpr auto kWindow = medianNetwork<kSize>();
};

using Vector = Simd::Vector;

// What is watched by AddressSanitizer goes through the comparators in a loop: with checks at each access to a constant
// place GCC takes a minute for this file.
#ifdef __SANITIZE_ADDRESS__
constexpr bool kInLoop = true;
#else
constexpr bool kInLoop = false;
#endif

template <int kCount>
inline void compareInLoop(const Network<kCount>& network, Vector* values)
{
  for (int i = 0; i < network.count; ++i)
  {
    const Comparator one = network.comparators[i];
    const Vector a = values[one.first];
    const Vector b = values[one.second];
    if (one.needs_lesser) values[one.first] = Simd::lesserBytes(a, b);
    if (one.needs_greater) values[one.second] = Simd::greaterBytes(a, b);
  }
}

template <int kFirst, int kSecond, bool kLesser, bool kGreater>
[[gnu::always_inline]] inline void compare(Vector* values)
{
  const Vector a = values[kFirst];
  const Vector b = values[kSecond];
  if (kLesser) values[kFirst] = Simd::lesserBytes(a, b);
  if (kGreater) values[kSecond] = Simd::greaterBytes(a, b);
}

// Comparators with constant places, so that the compiler keeps the values in registers.
template <int kSize, std::size_t... kIndices>
[[gnu::always_inline]] inline void sortColumn(Vector* values, std::index_sequence<kIndices...> /*indices*/)
{
  constexpr auto& all = Networks<kSize>::kColumn.comparators;
  if constexpr (kInLoop)
    compareInLoop(Networks<kSize>::kColumn, values);
  else
    (compare<all[kIndices].first, all[kIndices].second, true, true>(values), ...);
}

template <int kSize, std::size_t... kIndices>
[[gnu::always_inline]] inline void findMedian(Vector* values, std::index_sequence<kIndices...> /*indices*/)
{
  constexpr auto& all = Networks<kSize>::kWindow.comparators;
  if constexpr (kInLoop)
    compareInLoop(Networks<kSize>::kWindow, values);
  else
    (compare<all[kIndices].first, all[kIndices].second, all[kIndices].needs_lesser, all[kIndices].needs_greater>(
         values),
     ...);
}

/// Calls work(begin) for blocks of kBytes bytes that cover `count` bytes, the last of which may overlap another one.
template <class Work>
[[gnu::always_inline]] inline void forBlocks(int count, const Work& work)
{
  for (int begin = 0; begin + kBytes < count; begin += kBytes)
    work(begin);
  work(count - kBytes);
}

template <int kSize>
void sortColumnsOf(const std::uint8_t* const* rows, int count, std::uint8_t* const* sorted)
{
  constexpr auto& network = Networks<kSize>::kColumn;
  forBlocks(count,
            [&](int begin)
            {
              Vector values[kSize];
              for (int y = 0; y < kSize; ++y)
                values[y] = Simd::load(rows[y] + begin);
              sortColumn<kSize>(values, std::make_index_sequence<network.count>());
              for (int y = 0; y < kSize; ++y)
                Simd::store(sorted[y] + begin, values[network.order.numbers[y]]);
            });
}

template <int kSize>
void mediansOf(const std::uint8_t* const* sorted, int channels, int count, std::uint8_t* medians)
{
  constexpr auto& network = Networks<kSize>::kWindow;
  forBlocks(count,
            [&](int begin)
            {
              Vector values[kSize * kSize];
              for (int x = 0; x < kSize; ++x)
                for (int y = 0; y < kSize; ++y)
                  values[x * kSize + y] = Simd::load(sorted[y] + begin + (x - kSize / 2) * channels);
              findMedian<kSize>(values, std::make_index_sequence<network.count>());
              Simd::store(medians + begin, values[network.order.numbers[kSize * kSize / 2]]);
            });
}

void sortColumns(const std::uint8_t* const* rows, int size, int count, std::uint8_t* const* sorted)
{
  if (size == 7)
    sortColumnsOf<7>(rows, count, sorted);
  else if (size == 9)
    sortColumnsOf<9>(rows, count, sorted);
  else
    sortColumnsOf<kMaxSize>(rows, count, sorted);
}

void findMedians(const std::uint8_t* const* sorted, int size, int channels, int count, std::uint8_t* medians)
{
  if (size == 7)
    mediansOf<7>(sorted, channels, count, medians);
  else if (size == 9)
    mediansOf<9>(sorted, channels, count, medians);
  else
    mediansOf<kMaxSize>(sorted, channels, count, medians);
}

#endif

}  // namespace

template <>
const MedianKernels KernelTable<MedianKernels, ROBOT_VISION_SET>::table = {
#ifdef ROBOT_VISION_VECTORS
    sortColumns,
    findMedians,
    kMaxSize,
    kBytes,
#else
    nullptr,
    nullptr,
    0,
    0,
#endif
};

}  // namespace robot_vision
