#include "scene_renderer.hpp"

#include <algorithm>

#include "robot_vision/scene/scene.hpp"

namespace robot_vision::scene
{

namespace
{

// Draws the shadow of `board` into the image of the wall behind it, a little to the right and below.
void shadeBehind(cv::Mat& image, const Board& wall, const Board& board)
{
  const double strength = 0.42, right = 0.012, down = 0.022, blur = 0.016;  // m
  const double pixels_per_metre = image.cols / wall.size.width;
  std::vector<cv::Point2d> polygon;
  for (const cv::Point3d& corner : corners(wall.pose.inv() * board.pose, board.size))
  {
    const double x = corner.x + right + wall.size.width / 2.0, y = wall.size.height / 2.0 - corner.y + down;
    polygon.emplace_back(x * pixels_per_metre, y * pixels_per_metre);
  }
  castShadow(image, polygon, strength, blur * pixels_per_metre);
}

}  // namespace

SceneRenderer::SceneRenderer(const cv::Mat& poster_bgr)
{
  const cv::Mat poster = poster_bgr.empty() ? posterPattern() : poster_bgr;
  const Room r = buildRoom();
  poster_aspect_ = static_cast<double>(poster.cols) / poster.rows;
  const Board poster_board = posterBoard(poster_aspect_);
  const int rim = std::max(cvRound(0.03 * std::max(poster.cols, poster.rows)), 1);  // px, width of the poster's frame
  const double rim_size = 2.0 * rim * poster_board.size.width / poster.cols;
  const Board framed_board = {poster_board.pose, poster_board.size + cv::Size2d(rim_size, rim_size)};
  cv::Mat framed;
  cv::copyMakeBorder(poster, framed, rim, rim, rim, rim, cv::BORDER_CONSTANT, cv::Scalar(44, 58, 72));

  cv::Mat floor = floorImage(r.floor.size);
  shadeBehind(floor, r.floor, tagBoard(1));
  floor_ = {imageTexture(floor), r.floor};
  cv::Mat wall = wallImage(r.back_wall.size, 1.0);
  for (const Board& board : {framed_board, checkerBoard(), qrBoard(), tagBoard(0)})
    shadeBehind(wall, r.back_wall, board);

  boards_ = {{imageTexture(plainImage(r.ceiling.size, 0.05, {196, 204, 208})), r.ceiling},
             {imageTexture(wall), r.back_wall},
             {imageTexture(wallImage(r.left_wall.size, 0.86)), r.left_wall},
             {imageTexture(wallImage(r.right_wall.size, 0.92)), r.right_wall}};
  for (const Board& skirting : r.skirting)
    boards_.push_back({imageTexture(plainImage(skirting.size, 0.004, {206, 216, 220})), skirting});
  boards_.push_back({imageTexture(framed), framed_board});
  boards_.push_back({cellTexture(checkerCells()), checkerBoard()});
  boards_.push_back({cellTexture(qrCells()), qrBoard()});
  for (const int id : {0, 1})
    boards_.push_back({cellTexture(tagCells(id)), tagBoard(id)});

  shadow_ = imageTexture(shadowDisc(150.0));
  crate_ = {imageTexture(crateImage(0.94)), imageTexture(crateImage(0.78)), imageTexture(crateImage(1.08))};
}

void SceneRenderer::draw(double seconds, const cv::Affine3d& world, Canvas& canvas) const
{
  const cv::Vec3d to_light(-0.45, 0.45, 0.77);  // in the world
  canvas.background({140, 165, 178});           // shows a little where two anti-aliased edges meet
  canvas.board(floor_.texture, world * floor_.board.pose, floor_.board.size);
  canvas.line(world);
  drawShadows(seconds, world, canvas);
  for (const Item& item : boards_)
    canvas.board(item.texture, world * item.board.pose, item.board.size);
  drawBox(seconds, world, canvas);
  canvas.ball(world * ballCenter(seconds), kSceneBallRadius, world.rotation() * to_light);
}

void SceneRenderer::drawShadows(double seconds, const cv::Affine3d& world, Canvas& canvas) const
{
  const double box_width = 2.0 * kBoxSize[0], spread = 1.2;
  const cv::Vec3d box = boxPose(seconds).translation();
  const cv::Point3d ball = ballCenter(seconds);
  const double ball_width = 2.0 * kSceneBallRadius + spread * 0.4 * ball.z;  // wider when the ball is higher
  for (const Board& shadow :
       {onFloor(box[0], box[1], {box_width, box_width}), onFloor(ball.x, ball.y, {ball_width, ball_width})})
    canvas.shadow(shadow_, world * shadow.pose, shadow.size);
}

void SceneRenderer::drawBox(double seconds, const cv::Affine3d& world, Canvas& canvas) const
{
  const double x = kBoxSize[0] / 2.0, y = kBoxSize[1] / 2.0, z = kBoxSize[2] / 2.0;
  const cv::Affine3d box = world * boxPose(seconds);
  const auto face = [&](const Texture& texture, const cv::Vec3d& turn, const cv::Vec3d& middle, double w, double h) {
    canvas.board(texture, box * cv::Affine3d(turn, middle), {w, h});
  };
  const double quarter = CV_PI / 2.0;
  face(crate_[0], {0, 0, 0}, {0, 0, z}, 2 * x, 2 * y);
  face(crate_[1], {0, quarter, 0}, {x, 0, 0}, 2 * z, 2 * y);
  face(crate_[1], {0, -quarter, 0}, {-x, 0, 0}, 2 * z, 2 * y);
  face(crate_[2], {-quarter, 0, 0}, {0, y, 0}, 2 * x, 2 * z);
}

}  // namespace robot_vision::scene
