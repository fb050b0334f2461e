#pragma once

#include <nodelet/nodelet.h>

#include <boost/shared_ptr.hpp>

#include <functional>

namespace robot_vision
{

/// Make the nodelets without a plugin loader, for the programs that run one nodelet as a node.
boost::shared_ptr<nodelet::Nodelet> makeBrightness();
boost::shared_ptr<nodelet::Nodelet> makeDenseFlow();
boost::shared_ptr<nodelet::Nodelet> makeDepthRegistration();
boost::shared_ptr<nodelet::Nodelet> makeEdgeDetector();
boost::shared_ptr<nodelet::Nodelet> makeFilter();
boost::shared_ptr<nodelet::Nodelet> makeSegmenter();
boost::shared_ptr<nodelet::Nodelet> makeSpectrum();
boost::shared_ptr<nodelet::Nodelet> makeStereoMatcher();

/// `on_end` is called from the capture thread when the source has ended, with 0, or 1 after an error that was logged.
boost::shared_ptr<nodelet::Nodelet> makeCamera(const std::function<void(int exit_code)>& on_end);

}  // namespace robot_vision
