#include "factories.hpp"
#include "ros/images/run_nodelet.hpp"

int main(int argc, char** argv)
{
  const char* about = R"(Publishes the frames of a camera, a Kinect, a video, a folder of images or a synthetic scene.

Publishes ~image_raw, ~image_mono, ~camera_info and /diagnostics, with _source:=synthetic also ~ground_truth and /tf.
~stop_capture and ~start_capture (std_srvs/Empty) stop and start the capture. dynamic_reconfigure changes the controls
of a device in ~controls. ~set_camera_info (sensor_msgs/SetCameraInfo) sets the calibration and saves it. With _views:=stereo or _views:=rgbd
there are two images at a time, each with all that belongs to one: in ~left and ~right, or in ~rgb and ~depth.
)";
  const auto make = [] { return robot_vision::makeCamera(robot_vision::endNode); };
  return robot_vision::runNodelet(argc, argv, "camera", about, make);
}
