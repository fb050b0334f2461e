#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "robot_vision/meshes/mesh.hpp"
#include "robot_vision/recognition/view_model.hpp"

namespace robot_vision
{

/// Learns what an object looks like from its mesh, in m, which is drawn from all directions of a ViewTree. The views of
/// the same mesh and parameters are the same to the bit, whatever the number of threads, and whether training was
/// interrupted. Never changes: threads may share it.
///
/// Source of views that are made of a mesh, and of features that are spread over the contour and the inside of an
/// object: Hinterstoisser, Lepetit, Ilic, Holzer, Bradski, Konolige, Navab: Model Based Training, Detection and Pose
/// Estimation of Texture-Less 3D Objects in Heavily Cluttered Scenes, ACCV 2012.
class ViewTrainer
{
public:
  /// Told how many views there are, and how many there will be; false: training is to end.
  using Progress = std::function<bool(int done, int all)>;

  /// Throws std::invalid_argument as validate() of the mesh and of the parameters and SymmetryGroup do, and for a mesh
  /// without any extent.
  explicit ViewTrainer(const Mesh& mesh, const ViewParams& params = ViewParams(),
                       const std::vector<Symmetry>& symmetries = {});
  ~ViewTrainer();

  /// A model that has no view yet.
  const ViewModel& untrained() const;

  /// Adds views to a model until it has all or `progress` says false. It is called by this thread after some views, and
  /// at the end. `threads` are 1 to 64, as far as OpenCV's setting allows. Throws std::invalid_argument for another
  /// number of them, and if the model is not one of this mesh, parameters and symmetries.
  void train(ViewModel& model, int threads = 1, const Progress& progress = Progress()) const;

private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

/// All of it at once. Throws as ViewTrainer does.
ViewModel trainViews(const Mesh& mesh, const ViewParams& params = ViewParams(),
                     const std::vector<Symmetry>& symmetries = {}, int threads = 1);

}  // namespace robot_vision
