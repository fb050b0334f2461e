#include "robot_vision/recognition/view_trainer.hpp"

#include <algorithm>
#include <opencv2/core/affine.hpp>

#include "core/common/in_this_thread.hpp"
#include "robot_vision/common/range.hpp"
#include "robot_vision/meshes/mesh_renderer.hpp"
#include "robot_vision/recognition/view_tree.hpp"
#include "view_features.hpp"

namespace robot_vision
{
namespace
{

constexpr int kViewsAtOnce = 8;  // of a thread, before progress is told

bool equalSymmetries(const std::vector<Symmetry>& a, const std::vector<Symmetry>& b)
{
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Symmetry& x, const Symmetry& y) { return x.axis == y.axis && x.fold == y.fold; });
}

bool equalExtents(const MeshExtent& a, const MeshExtent& b)
{
  return a.center == b.center && a.size == b.size && a.diameter == b.diameter && a.radius == b.radius;
}

}  // namespace

struct ViewTrainer::Impl
{
  Impl(const Mesh& mesh, const ViewParams& params, const std::vector<Symmetry>& symmetries)
    : renderer(mesh), tree(viewTree(params.subdivisions, SymmetryGroup(symmetries)))
  {
    validate(params);
    untrained.params = params;
    untrained.symmetries = symmetries;
    untrained.extent = renderer.extent();
    untrained.levels = tree.levels;
    require(untrained.extent.radius > 0.0, "the radius of the mesh", untrained.extent.radius, "above 0");
  }

  void train(ViewModel& model, int threads, const Progress& progress) const
  {
    requireRange("threads", threads, 1, 64);
    checkModel(model);
    const std::size_t all = tree.directions.size();
    std::vector<ViewFeatureFinder> finders(static_cast<std::size_t>(threads),
                                           ViewFeatureFinder(model.params, model.extent.radius));
    std::vector<MeshView> images(static_cast<std::size_t>(threads));
    bool go_on = true;
    while (go_on && model.views.size() < all)
    {
      const std::size_t begin = model.views.size(), most = static_cast<std::size_t>(kViewsAtOnce * threads);
      const std::size_t count = std::min(all - begin, most);
      std::vector<View> views(count);
      const auto work = [&](const cv::Range& parts)
      {
        for (int part = parts.start; part < parts.end; ++part)
          for (auto i = static_cast<std::size_t>(part); i < count; i += static_cast<std::size_t>(threads))
            views[i] = view(begin + i, finders[static_cast<std::size_t>(part)], images[static_cast<std::size_t>(part)]);
      };
      cv::parallel_for_({0, threads}, work, threads);
      model.views.insert(model.views.end(), views.begin(), views.end());
      if (progress) go_on = progress(static_cast<int>(model.views.size()), static_cast<int>(all));
    }
  }

  View view(std::size_t i, ViewFeatureFinder& finder, MeshView& image) const
  {
    const ViewDirection& direction = tree.directions[i];
    const cv::Matx33d rotation = lookedAtFrom(direction.direction);
    const StudioCamera& camera = finder.camera();
    const cv::Vec3d place = cv::Vec3d(0, 0, camera.distance) - rotation * untrained.extent.center;
    RenderParts parts;
    parts.bgr = parts.normals = true;
    renderer.render(camera.K(), cv::Affine3d(rotation, place), {0, 0, StudioCamera::kSide, StudioCamera::kSide}, image,
                    parts);
    View found = finder.find(image, rotation);
    found.spin = direction.spin;
    found.parent = direction.parent;
    return found;
  }

  void checkModel(const ViewModel& model) const
  {
    const bool same = equalFields(model.params, untrained.params) && model.levels == untrained.levels &&
                      equalSymmetries(model.symmetries, untrained.symmetries) &&
                      equalExtents(model.extent, untrained.extent) && model.views.size() <= tree.directions.size();
    require(same, "the model to train", "of another mesh, or other parameters or symmetries", "of these");
  }

  MeshRenderer renderer;
  ViewTree tree;
  ViewModel untrained;
};

ViewTrainer::ViewTrainer(const Mesh& mesh, const ViewParams& params, const std::vector<Symmetry>& symmetries)
  : impl_(std::make_unique<Impl>(mesh, params, symmetries))
{
}

ViewTrainer::~ViewTrainer() = default;

const ViewModel& ViewTrainer::untrained() const
{
  return impl_->untrained;
}

void ViewTrainer::train(ViewModel& model, int threads, const Progress& progress) const
{
  impl_->train(model, threads, progress);
}

ViewModel trainViews(const Mesh& mesh, const ViewParams& params, const std::vector<Symmetry>& symmetries, int threads)
{
  const ViewTrainer trainer(mesh, params, symmetries);
  ViewModel model = trainer.untrained();
  trainer.train(model, threads);
  return model;
}

}  // namespace robot_vision
