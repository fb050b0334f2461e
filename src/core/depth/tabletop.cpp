#include "robot_vision/depth/tabletop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "plane_search.hpp"
#include "robot_vision/common/range.hpp"
#include "table_frame.hpp"
#include "table_objects.hpp"

namespace robot_vision
{
namespace
{

constexpr double kMinDeviations = 3.0;  // of the noise, that an object is higher than its table, a wall before its end
constexpr double kMaxWallCosine = 0.5;  // between the normals of a wall and of the table before it

}  // namespace

void validate(const TabletopParams& params)
{
  checkFields(params);
  require(params.max_height > params.min_height, "max_height", params.max_height,
          "above min_height, " + toText(params.min_height));
}

struct TabletopFinder::Impl
{
  Impl(const CameraModel& camera, const PlaneParams& planes, const TabletopParams& p)
    : params((validate(p), p)), search(camera, planes), objects(search.rays(), p.gap, p.min_pixels)
  {
  }

  const Tabletop& find(const cv::Mat& depth, const std::string& encoding, const cv::Vec3d& up)
  {
    for (const double value : up.val)
      requireFinite("up", value);
    search.find(depth, encoding);
    found.tables.clear();
    objects.begin(depth.size());
    is_table = {};
    const std::vector<std::size_t> tables = tablesOf(up);
    for (const std::size_t i : tables)
      is_table[i + 1] = 1;
    for (const std::size_t i : tables)
      add(search.found().planes[i]);
    found.labels = objects.labels();
    return found;
  }

  /// The indices of the planes that are tables, the nearest first.
  std::vector<std::size_t> tablesOf(const cv::Vec3d& up) const
  {
    const std::vector<Plane>& planes = search.found().planes;
    const double length = cv::norm(up), least = std::cos(params.up_tolerance * CV_PI / 180.0);
    std::vector<std::size_t> tables;
    for (std::size_t i = 0; i < planes.size(); ++i)
    {
      const bool faces_up = length == 0.0 || planes[i].normal.dot(up) >= least * length;
      if (faces_up && TableFrame(planes[i]).area() >= params.min_table_area) tables.push_back(i);
    }
    if (length == 0.0 && tables.size() > 1) tables.resize(1);
    std::stable_sort(tables.begin(), tables.end(),
                     [&](std::size_t a, std::size_t b) { return planes[a].distance < planes[b].distance; });
    return tables;
  }

  void add(const Plane& plane)
  {
    const TableFrame frame(plane);
    const Footprint around = footprint(frame.hull());
    Table table;
    table.plane = plane;
    table.pose = frame.poseOf(around, 0.0);
    table.size = {around.length, around.width};
    findCandidates(plane, frame);
    table.objects = objects.find(depths, frame);
    found.tables.push_back(std::move(table));
  }

  /// Whether a plane is upright, and no part of a table is behind it.
  bool isWall(const Plane& plane, const Plane& table) const
  {
    if (std::abs(plane.normal.dot(table.normal)) > kMaxWallCosine) return false;
    return std::all_of(table.hull.begin(), table.hull.end(),
                       [&](const cv::Point3d& corner)
                       {
                         const double before = plane.normal.dot(cv::Vec3d(corner)) + plane.distance;
                         return before > -params.margin - kMinDeviations * search.deviation(corner.z);
                       });
  }

  /// The walls that a table ends at.
  std::vector<Plane> wallsOf(const Plane& table) const
  {
    std::vector<Plane> walls;
    for (const Plane& plane : search.found().planes)
      if (isWall(plane, table)) walls.push_back(plane);
    return walls;
  }

  /// Whether what a ray meets at a depth is a part of a wall, as far as the noise tells, or behind one.
  bool isBeyond(const std::vector<Plane>& walls, const cv::Vec3d& ray, double z) const
  {
    return std::any_of(walls.begin(), walls.end(),
                       [&](const Plane& wall)
                       {
                         const double along = wall.normal.dot(ray);
                         const double error = kMinDeviations * search.deviation(z) * std::abs(along);
                         return z * along + wall.distance < error;
                       });
  }

  /// Writes the depths of pixels that can show what stands on a table, and 0 for all others.
  void findCandidates(const Plane& plane, const TableFrame& frame)
  {
    const cv::Vec3f normal = plane.normal;
    const auto distance = static_cast<float>(plane.distance);
    const auto low = static_cast<float>(params.min_height), high = static_cast<float>(params.max_height);
    const std::vector<Plane> walls = wallsOf(plane);
    depths.create(search.inverse().size(), CV_32FC1);
    for (int y = 0; y < depths.rows; ++y)
    {
      const auto* const inverse = search.inverse().ptr<float>(y);
      const auto *const ray_x = search.rays().x.ptr<float>(y), *const ray_y = search.rays().y.ptr<float>(y);
      const auto* const of_planes = search.found().labels.ptr(y);
      const auto* const taken = objects.labels().ptr<std::uint16_t>(y);
      auto* const to = depths.ptr<float>(y);
      for (int x = 0; x < depths.cols; ++x)
      {
        to[x] = 0.0F;
        const float w = inverse[x], along = normal[0] * ray_x[x] + normal[1] * ray_y[x] + normal[2];
        const float height = along + distance * w;  // divided by the depth
        if (!(w > 0.0F && height >= low * w && height <= high * w)) continue;
        if (is_table[of_planes[x]] != 0 || taken[x] != 0) continue;
        const double z = 1.0 / w;
        if (height * z < kMinDeviations * search.deviation(z) * std::abs(along)) continue;
        const cv::Vec3d ray(ray_x[x], ray_y[x], 1.0);
        if (!frame.isAbove(frame.local(z * ray), params.margin) || isBeyond(walls, ray, z)) continue;
        to[x] = static_cast<float>(z);
      }
    }
  }

  TabletopParams params;
  PlaneSearch search;
  TableObjects objects;
  Tabletop found;
  std::array<std::uint8_t, 256> is_table{};  // of the planes, by their labels
  cv::Mat depths;                            // of what can be objects of one table
};

TabletopFinder::TabletopFinder(const CameraModel& camera, const PlaneParams& planes, const TabletopParams& params)
  : impl_(std::make_unique<Impl>(camera, planes, params))
{
}

TabletopFinder::~TabletopFinder() = default;

const Tabletop& TabletopFinder::find(const cv::Mat& depth, const std::string& encoding, const cv::Vec3d& up)
{
  return impl_->find(depth, encoding, up);
}

const PlaneSegmentation& TabletopFinder::planes() const
{
  return impl_->search.found();
}

}  // namespace robot_vision
