#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "core/recognition/near_places.hpp"
#include "core/recognition/place_search.hpp"

using namespace robot_vision;

TEST(Places, areAlsoWhereThereIsNoDepth)
{
  CameraModel model;
  model.width = 160;
  model.height = 120;
  model.K = {131.0, 0.0, 79.5, 0.0, 131.0, 59.5, 0.0, 0.0, 1.0};
  const ViewCamera camera(model);
  cv::Mat depth(120, 160, CV_32FC1, cv::Scalar(0.8));
  const cv::Rect thing(60, 40, 30, 40), shadow(40, 40, 20, 40);
  depth(thing) = 0.5;
  depth(shadow) = 0.0;
  ObservedFrame frame;
  frame.observe(camera, cv::Mat(), depth, {30, 0.05F});
  for (const auto& [nearest, farthest] : {std::pair(0.3F, 0.9F), std::pair(0.3F, 5.0F), std::pair(0.6F, 5.0F)})
  {
    const std::vector<Place> places = findPlaces(frame, camera, 0.02, 0.1, 1.0F / farthest, 1.0F / nearest, cv::Mat());
    const auto inShadow = [&](const Place& place) { return shadow.contains({place.x, place.y}); };
    EXPECT_GT(std::count_if(places.begin(), places.end(), inShadow), 5) << nearest << " " << farthest;
  }
}

TEST(NearPlaces, tellsAllThatAreWithinTheDistance)
{
  constexpr double kDistance = 0.03;
  cv::RNG random(5);
  std::vector<cv::Vec3d> places;
  NearPlaces near(kDistance);
  for (std::size_t i = 0; i < 300; ++i)
  {
    places.emplace_back(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(0.0, 0.2));
    near.add(places.back(), i);
  }
  std::size_t tested = 0, all = 0;
  for (int k = 0; k < 200; ++k)
  {
    const cv::Vec3d place(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(0.0, 0.2));
    std::vector<bool> is_told(places.size());
    EXPECT_FALSE(near.anyNear(place,
                              [&](std::size_t i)
                              {
                                is_told[i] = true;
                                ++tested;
                                return false;
                              }));
    for (std::size_t i = 0; i < places.size(); ++i)
    {
      if (cv::norm(places[i] - place) >= kDistance) continue;
      EXPECT_TRUE(is_told[i]) << place << places[i];
      EXPECT_TRUE(near.anyNear(place, [&](std::size_t other) { return other == i; }));
    }
    all += places.size();
  }
  EXPECT_LT(tested, all / 4);
}

TEST(SpotCounts, countsWhatIsNearTheFirstPlaceOfASpot)
{
  SpotCounts spots(0.1);
  EXPECT_EQ(spots.add({0.0, 0.0, 1.0}), 1u);
  EXPECT_EQ(spots.add({0.09, 0.0, 1.0}), 2u);
  EXPECT_EQ(spots.add({0.11, 0.0, 1.0}), 1u) << "near the second place of the first spot alone";
  EXPECT_EQ(spots.add({0.0, 0.0, 1.099}), 3u);
  EXPECT_EQ(spots.add({0.0, 0.0, 1.1}), 1u);
  EXPECT_EQ(spots.add({0.15, 0.05, 1.0}), 2u);
}

TEST(NearPlaces, takesPlacesThatAreFartherAwayThanItCanCount)
{
  NearPlaces near(1e-9);
  const cv::Vec3d far(1e12, -1e12, 3.0);
  near.add(far, 7);
  EXPECT_TRUE(near.anyNear(far, [](std::size_t i) { return i == 7; }));
  EXPECT_FALSE(near.anyNear(cv::Vec3d(0.0, 0.0, 3.0), [](std::size_t) { return true; }));
}
