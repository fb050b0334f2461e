#include "view_search.hpp"

#include <algorithm>
#include <iterator>

#include "core/simd/kernel_tables.hpp"

namespace robot_vision
{
namespace
{

constexpr std::uint8_t kNever = 255;  // a floor that no score is above

/// Calls visit(number of the bit) for each bit that is set.
template <class Visit>
void forBits(std::uint64_t bits, const Visit& visit)
{
  for (; bits != 0; bits &= bits - 1)
    visit(__builtin_ctzll(bits));
}

}  // namespace

void ViewSearch::search(const std::uint8_t* planes, int first, int count, const ViewTemplates& templates,
                        std::vector<ViewHit>& hits)
{
  used_ = count == kPlacesAtOnce ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
  findPromising(planes, templates.coarse());
  for (int lane = 0; lane < kPlacesAtOnce; ++lane)
  {
    lane_floors_[lane] = lane < count ? floors_.fine : kNever;
    std::fill(std::begin(best_[lane]), std::end(best_[lane]), ViewHit{first + lane, 0, 0, 0});
  }
  for (const Promising& parent : promising_)
    searchChildren(planes, templates, parent);
  for (int lane = 0; lane < count; ++lane)
    std::copy_if(std::begin(best_[lane]), std::end(best_[lane]), std::back_inserter(hits),
                 [](const ViewHit& hit) { return hit.score > 0; });
}

void ViewSearch::findPromising(const std::uint8_t* planes, const TemplateCodes& coarse)
{
  const SearchKernels& loops = kernels<SearchKernels>();
  std::uint8_t floors[kPlacesAtOnce], scores[kPlacesAtOnce];
  for (int lane = 0; lane < kPlacesAtOnce; ++lane)
    floors[lane] = (used_ >> lane & 1) != 0 ? floors_.coarse : kNever;
  promising_.clear();
  for (std::size_t i = 0; i < coarse.templates.size(); ++i)
  {
    const std::uint64_t places = loops.above(planes, coarse.code(i), floors, scores);
    if (places == 0) continue;
    int best = 0;
    forBits(places, [&](int lane) { best = std::max(best, int{scores[lane]}); });
    promising_.push_back({i, best, places});
  }
  // The best first: they raise the floors for all others.
  std::stable_sort(promising_.begin(), promising_.end(),
                   [](const Promising& a, const Promising& b) { return a.score > b.score; });
}

void ViewSearch::searchChildren(const std::uint8_t* planes, const ViewTemplates& templates, const Promising& parent)
{
  int lowest = kNever;
  forBits(parent.places, [&](int lane) { lowest = std::min(lowest, int{lane_floors_[lane]}); });
  if (parent.score + floors_.slack < lowest) return;
  const SearchKernels& loops = kernels<SearchKernels>();
  std::uint8_t scores[kPlacesAtOnce];
  for (std::size_t i = templates.children(parent.index); i < templates.children(parent.index + 1); ++i)
    forBits(loops.above(planes, templates.fine().code(i), lane_floors_, scores),
            [&](int lane)
            {
              insert(lane, {best_[lane][0].place, static_cast<std::uint32_t>(i),
                            static_cast<std::uint32_t>(parent.index), scores[lane]});
            });
}

void ViewSearch::insert(int lane, const ViewHit& hit)
{
  ViewHit* const best = best_[lane];
  int at = kBest - 1;
  for (; at > 0 && best[at - 1].score < hit.score; --at)
    best[at] = best[at - 1];
  best[at] = hit;
  lane_floors_[lane] = std::max(lane_floors_[lane], best[kBest - 1].score);
}

}  // namespace robot_vision
