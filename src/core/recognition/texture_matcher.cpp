#include "robot_vision/recognition/texture_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

#include "robot_vision/common/range.hpp"
#include "robot_vision/depth/depth_image.hpp"
#include "robot_vision/image/encoding.hpp"
#include "texture_fit.hpp"
#include "texture_judgement.hpp"
#include "texture_match.hpp"
#include "texture_places.hpp"
#include "texture_search.hpp"

namespace robot_vision
{
namespace
{

constexpr std::uint64_t kSeed = 0x5EED;
constexpr double kMinProbability = 0.01;  // of a pose that is told
constexpr double kMinSpread = 0.02;       // of the diameter: inliers on a line tell no pose
constexpr double kMinDepthAgreement = 0.5;

/// The candidates without those that are used. Both are in order.
std::vector<std::size_t> without(const std::vector<std::size_t>& used, const std::vector<std::size_t>& candidates)
{
  std::vector<std::size_t> rest;
  std::set_difference(candidates.begin(), candidates.end(), used.begin(), used.end(), std::back_inserter(rest));
  return rest;
}

SeenImage seenImage(const cv::Mat& image, const cv::Mat& depth, const std::string& encoding, const CameraModel& camera,
                    const cv::Mat& mask)
{
  validate(camera);
  const cv::Size size(camera.width, camera.height);
  const std::string colors = image.channels() == 1 ? "mono8" : "bgr8";
  checkPixels(image, colors);
  require(image.size() == size, "the size of the image", toText(image.size()), toText(size) + " as of its camera");
  require(mask.empty() || (mask.type() == CV_8UC1 && mask.size() == size), "the mask", toText(mask.size()),
          "CV_8UC1 of " + toText(size));
  SeenImage seen{cv::Mat(), cv::Mat(), mask, &camera};
  toGray(image, colors, seen.gray);
  if (depth.empty()) return seen;
  checkDepth(depth, encoding, size);
  toMetres(depth, encoding, seen.metres);
  return seen;
}

}  // namespace

struct TextureMatcher::Impl
{
  /// The instances of an object among matches, some of them in two poses.
  std::vector<TexturedObject> objects(const std::vector<TextureMatch>& matches, int model, const MeshExtent& extent,
                                      const CameraModel& camera) const
  {
    const TextureSearchParams how{params.texture_rounds, params.texture_inliers, extent.diameter};
    std::vector<std::size_t> candidates(matches.size());
    std::iota(candidates.begin(), candidates.end(), std::size_t{0});
    std::vector<TexturedObject> found;
    cv::RNG random(kSeed);
    int instances = 0;
    for (int trial = 0; trial < 2 * params.texture_instances && instances < params.texture_instances; ++trial)
    {
      const auto first = searchTexture(matches, candidates, how, random);
      if (!first) break;
      const std::vector<TextureFit> fits = fitTexture(matches, candidates, *first, extent, errors.depth_bias);
      const bool is_fit = isFit(matches, fits[0], extent.diameter);
      for (const TextureFit& fit : fits)
      {
        if (!isFit(matches, fit, extent.diameter)) continue;
        const TexturedObject object = judgeTexture(matches, candidates, fit, model, extent, camera);
        if (object.probability >= kMinProbability) found.push_back(object);
      }
      instances += is_fit ? 1 : 0;
      // What has agreed with a pose that is none is tried no more.
      candidates = without(is_fit ? fits[0].found.inliers : first->inliers, candidates);
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const TexturedObject& a, const TexturedObject& b) { return a.probability > b.probability; });
    return found;
  }

  bool isFit(const std::vector<TextureMatch>& matches, const TextureFit& fit, double diameter) const
  {
    return countPlaces(matches, fit.found.inliers, diameter) >= params.texture_inliers &&
           spreadOf(matches, fit.found.inliers).deviations[1] >= kMinSpread * diameter &&
           !(fit.depth_agreement < kMinDepthAgreement);
  }

  TextureMatchParams params;
  DepthErrorParams errors;
  std::vector<TextureIndex> models;
};

TextureMatcher::TextureMatcher(const TextureMatchParams& params, const DepthErrorParams& errors)
{
  validate(params);
  validate(errors);
  impl_ = std::make_unique<Impl>(Impl{params, errors, {}});
}

TextureMatcher::~TextureMatcher() = default;
TextureMatcher::TextureMatcher(TextureMatcher&&) noexcept = default;
TextureMatcher& TextureMatcher::operator=(TextureMatcher&&) noexcept = default;

int TextureMatcher::add(const TextureModel& model)
{
  validate(model);
  require(!model.points.empty(), "the number of keypoints of a model", 0, "at least 1");
  impl_->models.emplace_back(model);
  return static_cast<int>(impl_->models.size()) - 1;
}

std::vector<TexturedObject> TextureMatcher::match(const cv::Mat& image, const cv::Mat& depth,
                                                  const std::string& encoding, const CameraModel& camera,
                                                  const cv::Mat& mask)
{
  const SeenImage seen = seenImage(image, depth, encoding, camera, mask);
  std::map<std::string, ImageTexture> textures;  // by detector
  std::vector<TexturedObject> found;
  for (std::size_t i = 0; i < impl_->models.size(); ++i)
  {
    TextureIndex& index = impl_->models[i];
    const std::string& detector = index.model().params.detector;
    const auto [at, is_new] = textures.try_emplace(detector);
    if (is_new) at->second = textureOf(seen, detector, impl_->params);
    const std::vector<TextureMatch> matches = index.match(seen, at->second, impl_->params, impl_->errors);
    const std::vector<TexturedObject> of_model =
        impl_->objects(matches, static_cast<int>(i), index.model().extent, camera);
    found.insert(found.end(), of_model.begin(), of_model.end());
  }
  return found;
}

}  // namespace robot_vision
