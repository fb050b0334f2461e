// The patterns that detectors look for: tags, QR code, checkerboard.

#include <array>

#include "robot_vision/tags/detection/tag_families.hpp"
#include "scene_textures.hpp"

namespace robot_vision::scene
{

namespace
{

// Print on paper: neither clips when noise is added, and black stays out of the reach of any colour filter.
const cv::Vec3b kBlack(28, 28, 28);
const cv::Vec3b kWhite(232, 236, 236);

constexpr std::array<const char*, 21> kQrModules = {
    "#######...#...#######", "#.....#..###..#.....#", "#.###.#.#.###.#.###.#", "#.###.#.#.###.#.###.#",
    "#.###.#.#..##.#.###.#", "#.....#.##..#.#.....#", "#######.#.#.#.#######", "........#####........",
    "#.#####.....#.#####..", ".##......#..#.####..#", ".#.######.##.#...#.#.", "#.#.#...#....#.####.#",
    "####.###...#.##......", "........##..#...#.###", "#######...#.###....#.", "#.....#.#.#..#..###..",
    "#.###.#.##.#..#.#..##", "#.###.#.###...#..#...", "#.###.#.######...#...", "#.....#....#.#.#.##..",
    "#######.##.#..#..#.#.",
};

}  // namespace

cv::Mat tagCells(int id)
{
  const cv::Mat pattern = robot_vision::tagCells("tag36h11", id);
  cv::Mat cells(pattern.size(), CV_8UC3, kBlack);
  cells.setTo(kWhite, pattern);
  return cells;
}

cv::Mat qrCells()
{
  const int modules = static_cast<int>(kQrModules.size()), quiet = 3;
  cv::Mat cells(modules + 2 * quiet, modules + 2 * quiet, CV_8UC3, kWhite);
  for (int y = 0; y < modules; ++y)
  {
    for (int x = 0; x < modules; ++x)
    {
      if (kQrModules[y][x] == '#') cells.at<cv::Vec3b>(quiet + y, quiet + x) = kBlack;
    }
  }
  return cells;
}

cv::Mat checkerCells()
{
  const int columns = 9, rows = 7;  // squares
  cv::Mat cells(2 * rows + 2, 2 * columns + 2, CV_8UC3, kWhite);
  for (int y = 0; y < rows; ++y)
  {
    for (int x = y % 2; x < columns; x += 2)
      cells(cv::Rect(1 + 2 * x, 1 + 2 * y, 2, 2)).setTo(kBlack);
  }
  return cells;
}

}  // namespace robot_vision::scene
