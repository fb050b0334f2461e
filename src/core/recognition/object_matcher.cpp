#include "robot_vision/recognition/object_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "candidate_search.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/depth/depth_image.hpp"

namespace robot_vision
{
namespace
{

constexpr double kStep = 1.0;            // between places, in cells
constexpr double kDistanceRatio = 1.12;  // between the distances that are tried without depth
constexpr SearchFloors kWithDepth{66, 65, 25}, kWithoutDepth{40, 53, 27};

}  // namespace

struct ObjectMatcher::Impl
{
  void observe(const cv::Mat& image, const cv::Mat& depth, const std::string& encoding, const CameraModel& of_camera)
  {
    if (!camera || !(camera->camera() == of_camera)) camera.emplace(of_camera);
    const cv::Size size(of_camera.width, of_camera.height);
    require(!image.empty() || !depth.empty(), "the frame", "empty", "an image, depths, or both");
    if (!image.empty())
    {
      require(image.type() == CV_8UC3 || image.type() == CV_8UC1, "the type of the image",
              cv::typeToString(image.type()), "CV_8UC3 or CV_8UC1");
      require(image.size() == size, "the size of the image", toText(image.size()), "the camera's, " + toText(size));
    }
    if (!depth.empty()) checkDepth(depth, encoding, size);
    frame.observe(*camera, image, depth, {params.contrast, static_cast<float>(params.jump)});
  }

  cv::Mat reducedMask(const cv::Mat& mask) const
  {
    if (mask.empty()) return {};
    const cv::Size size(camera->camera().width, camera->camera().height);
    require(mask.type() == CV_8UC1, "the type of the mask", cv::typeToString(mask.type()), "CV_8UC1");
    require(mask.size() == size, "the size of the mask", toText(mask.size()), "the camera's, " + toText(size));
    cv::Mat reduced;
    const cv::Size used = camera->size() * camera->block();
    cv::resize(mask(cv::Rect({}, used)), reduced, camera->size(), 0.0, 0.0, cv::INTER_NEAREST);
    if (!camera->places().empty())
      cv::remap(reduced, reduced, camera->places(), cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT);
    return reduced;
  }

  /// The inverse depth at which a diameter is as small in the image as it may be.
  float smallestInverse(double diameter) const
  {
    const double focal_length = camera->focalLength() * camera->block();
    return static_cast<float>(std::max(1.0 / params.max_distance, params.min_size / (diameter * focal_length)));
  }

  std::vector<Place> placesFor(double half_width, double diameter, const cv::Mat& mask) const
  {
    const double step = kStep * 2.0 * half_width / kCells;
    const float least = smallestInverse(diameter), most = static_cast<float>(1.0 / params.min_distance);
    if (frame.hasDepth()) return findPlaces(frame, *camera, step, half_width, least, most, mask);
    std::vector<Place> places;
    for (double inverse = most; inverse >= least; inverse /= kDistanceRatio)
    {
      const std::vector<Place> more = placesAt(static_cast<float>(inverse), frame, *camera, step, half_width, mask);
      places.insert(places.end(), more.begin(), more.end());
    }
    return places;
  }

  /// What of these models looks like the places, of each model. Threads take turns with the places; in which order the
  /// hits are does not matter.
  std::vector<std::vector<ViewHit>> search(const std::vector<int>& indices, const std::vector<Place>& places,
                                           double half_width)
  {
    const bool with_depth = frame.hasDepth();
    std::vector<const ViewTemplates*> templates;
    for (const int i : indices)
      templates.push_back(&models[static_cast<std::size_t>(i)].templates(with_depth));
    const int all = static_cast<int>(places.size()), threads = params.threads;
    planes.resize(static_cast<std::size_t>(threads));
    std::vector<std::vector<std::vector<ViewHit>>> found(planes.size(),
                                                         std::vector<std::vector<ViewHit>>(indices.size()));
    const auto work = [&](const cv::Range& parts)
    {
      ViewSearch search(with_depth ? kWithDepth : kWithoutDepth);
      for (int part = parts.start; part < parts.end; ++part)
        for (int first = part * kPlacesAtOnce; first < all; first += threads * kPlacesAtOnce)
        {
          const int count = std::min(kPlacesAtOnce, all - first);
          PlacePlanes& around = planes[static_cast<std::size_t>(part)];
          around.prepare(frame, *camera, places.data() + first, count, half_width);
          for (std::size_t k = 0; k < indices.size(); ++k)
            search.search(around.planes(), first, count, *templates[k], found[static_cast<std::size_t>(part)][k]);
        }
    };
    cv::parallel_for_({0, threads}, work, threads);
    for (std::size_t part = 1; part < found.size(); ++part)
      for (std::size_t k = 0; k < indices.size(); ++k)
        found[0][k].insert(found[0][k].end(), found[part][k].begin(), found[part][k].end());
    return std::move(found[0]);
  }

  /// Looks for models for which the same cells are looked at.
  void matchAlike(const std::vector<int>& indices, const cv::Mat& mask, std::vector<std::vector<PoseCandidate>>& found)
  {
    const double half_width = models[static_cast<std::size_t>(indices.front())].halfWidth();
    double diameter = 0.0;
    for (const int i : indices)
      diameter = std::max(diameter, models[static_cast<std::size_t>(i)].model().extent.diameter);
    const std::vector<Place> places = placesFor(half_width, diameter, mask);
    std::vector<std::vector<ViewHit>> hits = search(indices, places, half_width);
    const auto work = [&](const cv::Range& part)
    {
      for (auto k = static_cast<std::size_t>(part.start); k < static_cast<std::size_t>(part.end); ++k)
      {
        MatchedModel& model = models[static_cast<std::size_t>(indices[k])];
        found[static_cast<std::size_t>(indices[k])] =
            CandidateSearch(model, model.templates(frame.hasDepth()), frame, *camera)
                .find(places, hits[k], params.max_candidates);
      }
    };
    cv::parallel_for_({0, static_cast<int>(indices.size())}, work, params.threads);
  }

  std::vector<PoseCandidate> match(const cv::Mat& mask)
  {
    const cv::Mat reduced = reducedMask(mask);
    std::map<double, std::vector<int>> alike;  // models by half the width of their cells
    for (std::size_t i = 0; i < models.size(); ++i)
      alike[models[i].halfWidth()].push_back(static_cast<int>(i));
    std::vector<std::vector<PoseCandidate>> found(models.size());
    for (const auto& [half_width, indices] : alike)
      matchAlike(indices, reduced, found);
    std::vector<PoseCandidate> all;
    for (std::size_t i = 0; i < found.size(); ++i)
      for (PoseCandidate& candidate : found[i])
      {
        if (candidate.score < params.min_score) continue;
        candidate.model = static_cast<int>(i);
        all.push_back(candidate);
      }
    return all;
  }

  ObjectMatchParams params;
  std::vector<MatchedModel> models;
  std::optional<ViewCamera> camera;
  ObservedFrame frame;
  std::vector<PlacePlanes> planes;  // of each thread
};

void validate(const ObjectMatchParams& params)
{
  checkFields(params);
  require(params.max_distance > params.min_distance, "max_distance", params.max_distance,
          "above min_distance, " + toText(params.min_distance));
}

ObjectMatcher::ObjectMatcher(const ObjectMatchParams& params) : impl_(std::make_unique<Impl>())
{
  configure(params);
}

ObjectMatcher::~ObjectMatcher() = default;

void ObjectMatcher::configure(const ObjectMatchParams& params)
{
  validate(params);
  impl_->params = params;
}

int ObjectMatcher::add(const ViewModel& model)
{
  validate(model);
  require(model.isComplete(), "the number of views of a model", static_cast<double>(model.views.size()),
          std::to_string(model.levels.back()) + ": its training has not ended");
  impl_->models.emplace_back(model);
  return models() - 1;
}

int ObjectMatcher::models() const
{
  return static_cast<int>(impl_->models.size());
}

std::size_t ObjectMatcher::memory(int model) const
{
  requireRange("the index of a model", model, 0, models() - 1);
  return impl_->models[static_cast<std::size_t>(model)].memory();
}

std::vector<PoseCandidate> ObjectMatcher::match(const cv::Mat& image, const cv::Mat& depth, const std::string& encoding,
                                                const CameraModel& camera, const cv::Mat& mask)
{
  impl_->observe(image, depth, encoding, camera);
  return impl_->match(mask);
}

}  // namespace robot_vision
