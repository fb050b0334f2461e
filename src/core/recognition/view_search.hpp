#pragma once

#include <cstdint>
#include <vector>

#include "search_kernels.hpp"
#include "view_templates.hpp"

namespace robot_vision
{

/// A template that looks like what is around a place.
struct ViewHit
{
  int place = 0;             // index
  std::uint32_t index = 0;   // of the template, among the fine ones
  std::uint32_t parent = 0;  // of the coarse template that it belongs to
  std::uint8_t score = 0;    // features of its code, of kCodeFeatures
};

/// Scores that places have to have.
struct SearchFloors
{
  std::uint8_t coarse = 0;  // of a coarse template, for those that look like it to be compared, too
  std::uint8_t fine = 0;    // of what is found
  std::uint8_t slack = 0;   // how much better a template may be than the coarse one that looks like it
};

/// Finds the templates that look most like each of the places whose planes these are: some for each, the best.
class ViewSearch
{
public:
  static constexpr int kBest = 12;  // of each place

  explicit ViewSearch(const SearchFloors& floors) : floors_(floors) {}

  /// Adds what it finds of places first, ..., first + count - 1 to `hits`.
  void search(const std::uint8_t* planes, int first, int count, const ViewTemplates& templates,
              std::vector<ViewHit>& hits);

private:
  struct Promising
  {
    std::size_t index;
    int score;  // the best of all places
    std::uint64_t places;
  };

  void findPromising(const std::uint8_t* planes, const TemplateCodes& coarse);
  void searchChildren(const std::uint8_t* planes, const ViewTemplates& templates, const Promising& parent);
  void insert(int lane, const ViewHit& hit);

  SearchFloors floors_;
  std::vector<Promising> promising_;
  ViewHit best_[kPlacesAtOnce][kBest];
  std::uint8_t lane_floors_[kPlacesAtOnce] = {};
  std::uint64_t used_ = 0;
};

}  // namespace robot_vision
