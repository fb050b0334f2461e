#pragma once

#include <nodelet/nodelet.h>

#include <boost/shared_ptr.hpp>

#include <functional>

namespace robot_vision
{

/// The nodelets as objects, for the executables: a process of its own needs no plugin loader.
boost::shared_ptr<nodelet::Nodelet> makeBrightness();
boost::shared_ptr<nodelet::Nodelet> makeEdgeDetector();

/// `on_end` is called from the capture thread when the source has ended: 0, or 1 after an error that was logged.
boost::shared_ptr<nodelet::Nodelet> makeCamera(const std::function<void(int exit_code)>& on_end);

}  // namespace robot_vision
