#include "params.hpp"
#include "registry.hpp"
#include "robot_vision/camera/open_source.hpp"

using namespace robot_vision;

namespace camera_bindings
{

void bindCamera(py::module& m)
{
  bindParams<CaptureParams>(m, "CaptureParams", "What a camera is asked for.");
}

const Bindings kBindings("camera", {}, bindCamera);

}  // namespace camera_bindings
