#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "robot_vision/people/people_detector.hpp"
#include "support/images.hpp"
#include "support/refusal.hpp"

using namespace robot_vision;

TEST(PeopleDetector, takesNoiseOfAnySizeWithPaddedRows)
{
  std::size_t found = 0;  // which "default" takes none of
  for (const std::string model : {"default", "daimler"})
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(47, 200), cv::Size(64, 128), cv::Size(201, 133)})
      for (const std::string encoding : {"bgr8", "mono16"})
      {
        PeopleParams params;
        params.model = model;
        params.hit_threshold = -1.0;
        params.group_threshold = 0.0;
        params.padding = 24;
        const cv::Mat image = noise(size, matType(encoding), 5), before = image.clone();
        const std::vector<Person> people = PeopleDetector(params).detect(image, encoding);
        EXPECT_LE(people.size(), 50U);
        found += people.size();
        for (const Person& person : people)
          EXPECT_EQ(person.box & cv::Rect({0, 0}, size), person.box) << person.box << size;
        EXPECT_TRUE(equal(image, before));
      }
  EXPECT_GT(found, 0U);
}

TEST(PeopleDetector, refusesParametersOutOfRange)
{
  EXPECT_EQ(refusalWith(&PeopleParams::padding, 65), "padding is 65, must be from 0 to 64");
  EXPECT_EQ(refusalWith(&PeopleParams::model, std::string("cat")), "model is cat, must be default or daimler");
}
