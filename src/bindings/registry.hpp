#pragma once

#include <pybind11/pybind11.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace robot_vision
{

namespace py = pybind11;

/// The bindings of a room of the core. One such object in a source of the module registers them.
class Bindings
{
public:
  using Bind = void (*)(py::module& m);

  /// `uses` are the rooms whose types occur in these signatures: pybind11 knows the Python names only of what is bound
  /// already.
  Bindings(const std::string& room, std::vector<std::string> uses, Bind bind)
  {
    registry()[room] = {std::move(uses), bind};
  }

  /// Binds all that is registered, each room after those that it uses.
  static void bindAll(py::module& m)
  {
    while (!registry().empty())
      bindRoom(m, registry().begin()->first);
  }

private:
  struct Entry
  {
    std::vector<std::string> uses;
    Bind bind = nullptr;
  };

  static std::map<std::string, Entry>& registry()
  {
    static std::map<std::string, Entry> rooms;
    return rooms;
  }

  static void bindRoom(py::module& m, const std::string& room)
  {
    const auto entry = registry().extract(room);
    if (!entry) return;  // bound already
    for (const std::string& used : entry.mapped().uses)
      bindRoom(m, used);
    entry.mapped().bind(m);
  }
};

}  // namespace robot_vision
