#include "pose_clusters.hpp"

#include <algorithm>
#include <cmath>

namespace robot_vision
{
namespace
{

struct Cluster
{
  VotedPose first;
  cv::Vec3d center;  // m, of the first one
  double votes = 0.0, share = 0.0;
  cv::Vec3d centers = {};  // weighted sums
  cv::Matx33d rotations = {};
};

/// The rotation that is nearest to a matrix.
cv::Matx33d nearestRotation(const cv::Matx33d& sum)
{
  cv::Matx33d u, vt;
  cv::Matx31d w;
  cv::SVD::compute(sum, w, u, vt);
  const double sign = cv::determinant(u * vt) < 0.0 ? -1.0 : 1.0;
  return u * cv::Matx33d(1, 0, 0, 0, 1, 0, 0, 0, sign) * vt;
}

}  // namespace

std::vector<VotedPose> clusterPoses(std::vector<VotedPose> poses, const cv::Vec3d& center, double shift, double turn)
{
  std::stable_sort(poses.begin(), poses.end(),
                   [](const VotedPose& a, const VotedPose& b) { return a.votes > b.votes; });
  const double min_trace = 1.0 + 2.0 * std::cos(turn);
  std::vector<Cluster> clusters;
  for (const VotedPose& voted : poses)
  {
    const cv::Vec3d place = voted.pose * center;
    const cv::Matx33d rotation = voted.pose.rotation();
    const auto isNear = [&](const Cluster& cluster)
    {
      return cv::norm(cluster.center - place) < shift &&
             cluster.first.pose.rotation().dot(rotation) > min_trace;  // the trace of the one's inverse times the other
    };
    auto found = std::find_if(clusters.begin(), clusters.end(), isNear);
    if (found == clusters.end()) found = clusters.insert(found, {voted, place});
    found->votes += voted.votes;
    found->share = std::max(found->share, voted.share);
    found->centers += voted.votes * place;
    found->rotations += rotation * voted.votes;
  }
  std::vector<VotedPose> means;
  for (const Cluster& cluster : clusters)
  {
    const cv::Matx33d rotation = nearestRotation(cluster.rotations);
    const cv::Vec3d place = cluster.centers * (1.0 / cluster.votes);
    means.push_back({{rotation, place - rotation * center}, cluster.votes, cluster.share});
  }
  std::stable_sort(means.begin(), means.end(),
                   [](const VotedPose& a, const VotedPose& b) { return a.votes > b.votes; });
  return means;
}

}  // namespace robot_vision
