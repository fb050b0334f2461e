#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/meshes/mesh_camera.hpp"
#include "core/meshes/mesh_scratch.hpp"
#include "core/meshes/raster_kernels.hpp"
#include "core/meshes/vertex_kernels.hpp"

namespace robot_vision
{

/// Puts vertices, whose u and v are those of their rays, where a lens shows them; returns their bounds. `corner` is
/// that of the region, `min_w` the bound of w.
SeenBounds bend(const MeshCamera::Lens& lens, const cv::Point& corner, double min_w, std::vector<SeenVertex>& seen);

/// The part of a region, whose corner counts as 0, 0, that vertices within the bounds may be seen in.
cv::Rect seenPart(const SeenBounds& bounds, const SeenTriangles& triangles, const cv::Size& region);

/// The raster of a part of a region of a camera's image, with the depths that are there already. It is in the scratch.
Raster makeRaster(const MeshCamera& camera, const cv::Rect& region, const cv::Rect& part, const cv::Mat& depth,
                  MeshView::Scratch& scratch);

/// Takes what was drawn where a lens sees nothing away again. `corner` is that of the region.
void dropUnseen(const MeshCamera& camera, const cv::Point& corner, const cv::Rect& part, const Raster& raster);

}  // namespace robot_vision
