#include "robot_vision/edges/edges.hpp"

#include "arrays.hpp"
#include "params.hpp"
#include "registry.hpp"

using namespace robot_vision;
using namespace py::literals;

namespace edges_bindings
{

void bindEdges(py::module& m)
{
  bindParams<EdgeParams>(m, "EdgeParams", "How find_edges() finds edges.");
  m.def("find_edges", applyFilter<EdgeDetector, EdgeParams>, "image"_a, "encoding"_a = "bgr8",
        "params"_a = EdgeParams(),
        "Canny edges of the blurred gray image: (height, width) uint8, 255 on edges and 0 elsewhere.\n\n"
        "Raises ValueError for a parameter out of range or an image that is not of this encoding.");
}

const Bindings kBindings("edges", {}, bindEdges);

}  // namespace edges_bindings
