#include <opencv2/imgproc.hpp>

#include "core/image/histogram_equalization.hpp"
#include "operation_table.hpp"
#include "robot_vision/common/range.hpp"
#include "tile_equalization.hpp"

namespace robot_vision
{
namespace
{

constexpr int kMaxWideTiles = 16;  // to each side, of mono16: each has a table of 128 KB, to be filled for each image

}  // namespace

std::vector<Operation> histogramOperations()
{
  return {
      {"equalize",
       "Gray values spread evenly over the range: cv::equalizeHist.",
       kGrayOnly,
       "",
       {},
       eachTime(
           [](const OperationValues&, const OperationInput& in, cv::Mat& out)
           {
             cv::Mat gray;
             toEqualizedGray(in.image, in.encoding, gray, out);
           })},
      {"clahe",
       "Gray values spread evenly in each tile, with limited contrast: cv::CLAHE.",
       {"mono8", "mono16"},
       "",
       {{"limit", 2.0, Range{0.1, 40}, "", "of the contrast"},
        {"tiles", 8, Range{1, 64}, "", "to each side of the image"}},
       [](const OperationValues& v) -> Operation::Step
       {
         const int tiles = v.integer("tiles");
         TileEqualizer equalizer(v.number("limit"), tiles);
         return [equalizer, tiles](const OperationInput& in, cv::Mat& out) mutable
         {
           if (in.image.depth() == CV_16U)
             require(tiles <= kMaxWideTiles, "tiles", tiles, "at most " + toText(kMaxWideTiles) + " for mono16");
           equalizer.apply(in.image, out);
         };
       }},
      {"normalize",
       "Values stretched from the least and the largest to a range: cv::normalize.",
       kOpaque,
       "",
       {{"low", 0.0, Range{0, 255}, "gray levels", "of the least value"},
        {"high", 255.0, Range{0, 255}, "gray levels", "of the largest value; at least low"}},
       [](const OperationValues& v) -> Operation::Step
       {
         const double low = v.number("low"), high = v.number("high");
         require(high >= low, "high", high, "at least low, " + toText(low));
         return [low, high](const OperationInput& in, cv::Mat& out)
         {
           const double level = grayLevel(in.image);
           cv::normalize(in.image, out, low * level, high * level, cv::NORM_MINMAX);
         };
       }},
  };
}

}  // namespace robot_vision
