#pragma once

#include <gtest/gtest.h>
#include <ros/ros.h>

/// Runs the gtests of a rostest as a node, with this many threads for callbacks; returns what main() has to return.
inline int runTests(int argc, char** argv, const char* node, unsigned threads = 2)
{
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, node);
  ros::AsyncSpinner spinner(threads);
  const ros::NodeHandle keep_alive;  // keeps the node alive between the tests
  spinner.start();
  return RUN_ALL_TESTS();
}
