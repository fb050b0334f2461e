#pragma once

#include <gtest/gtest.h>
#include <ros/ros.h>

/// What the main() of a rostest returns: runs its tests as a node, with so many threads for callbacks.
inline int runTests(int argc, char** argv, const char* node, unsigned threads = 2)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, node);
  ros::AsyncSpinner spinner(threads);
  const ros::NodeHandle keep_alive;  // between the tests
  spinner.start();
  return RUN_ALL_TESTS();
}
