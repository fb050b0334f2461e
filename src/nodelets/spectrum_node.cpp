#include "factories.hpp"
#include "ros/images/run_nodelet.hpp"

int main(int argc, char** argv)
{
  const char* about = R"(Shows the frequencies of a camera's images, filters them, and finds how an image has shifted.

Subscribes to image while somebody subscribes to ~magnitude (mono8: of the discrete Fourier transform),
~filtered (mono8: the image with some of its frequencies), ~shift (px since the last frame) or
~processed_image (bgr8: the magnitude with the border of the filter). Also publishes /diagnostics.
)";
  return robot_vision::runNodelet(argc, argv, "spectrum", about, robot_vision::makeSpectrum);
}
