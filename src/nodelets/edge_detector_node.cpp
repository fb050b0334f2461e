#include "factories.hpp"
#include "ros/run_nodelet.hpp"

int main(int argc, char** argv)
{
  return robot_vision::runNodelet(argc, argv, "edge_detector", robot_vision::makeEdgeDetector);
}
