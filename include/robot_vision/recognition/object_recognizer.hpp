#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <opencv2/core/affine.hpp>
#include <string>
#include <vector>

#include "robot_vision/common/fields.hpp"
#include "robot_vision/recognition/object_shape.hpp"
#include "robot_vision/recognition/pose_candidate.hpp"
#include "robot_vision/recognition/pose_refiner.hpp"
#include "robot_vision/recognition/pose_verifier.hpp"
#include "robot_vision/recognition/recognition_frame.hpp"

namespace robot_vision
{

struct RecognizerParams
{
  double threshold = 0.6;
  double sure = 0.98;
  int max_candidates = 100;
  int max_refined = 8;
  int max_per_place = 6;
  double min_unclaimed = 0.5;

  template <class Visit>
  static void fields(Visit&& visit)
  {
    visit("threshold", &RecognizerParams::threshold, Range{0, 1}, "",
          "least probability of an object that is reported");
    visit("sure", &RecognizerParams::sure, Range{0, 1}, "",
          "probability from which other poses at the same place are not tried any more");
    visit("max_candidates", &RecognizerParams::max_candidates, Range{1, 100000}, "",
          "of each model that are looked at, those with the best scores");
    visit(
        "max_refined", &RecognizerParams::max_refined, Range{1, 100000}, "",
        "of them that are refined and verified where the object is not, those that agree best with the depths and the "
        "matcher");
    visit("max_per_place", &RecognizerParams::max_per_place, Range{1, 1000}, "", "of those that are at one place");
    visit("min_unclaimed", &RecognizerParams::min_unclaimed, Range{0, 1}, "",
          "share of an object's pixels that no better one explains");
  }
};

/// An object that is there.
struct RecognizedObject
{
  int model = 0;                    // index, in the order in which the models were added
  cv::Affine3d pose;                // of the object's frame, that of its mesh, in the camera's optical frame, m
  cv::Matx66d covariance;           // of x, y, z (m) and the rotations about x, y, z (rad) along the camera's axes
  std::vector<FreeAxis> free_axes;  // in the mesh's frame, about which it could be turned by any angle
  double probability = 0.0;         // 0 to 1
  double occlusion = 0.0;           // 0 to 1, share of the object that is hidden
  double match_score = 0.0;         // of its candidate
  cv::Rect box;                     // px, around it in the image
  PoseEvidence evidence;
};

/// Why a model was not found.
enum class MissReason
{
  kNone,         // it was found
  kNoCandidate,  // nothing in the frame looks like it
  kOutside,      // its candidates are outside of the image, or behind the camera
  kTooSmall,     // too far away: too few pixels
  kNoDepth,      // there is no depth where it may be
  kNotThere,     // the depths are those of something else
  kImprobable,   // below the threshold
  kClaimed,      // something else explains the same pixels better
};

/// What became of the candidates of a model.
struct ModelReport
{
  int model = 0;
  int candidates = 0;                            // that came
  int refined = 0;                               // of them that were refined and verified
  int found = 0;                                 // objects
  double best_probability = 0.0;                 // of all that were verified
  double best_score = 0.0;                       // of the candidates
  double nearest_distance = 0.0;                 // m, of the candidates' middles; 0: there is none
  MissReason reason = MissReason::kNoCandidate;  // of the candidate that came farthest
};

/// The reason as a line for a user: "below the threshold: the best probability is 0.43".
std::string reasonText(const ModelReport& report);

struct Recognition
{
  std::vector<RecognizedObject> objects;  // the most probable first
  std::vector<ModelReport> reports;       // of each model, in their order
};

/// Tells which of the candidates of a matcher are objects, and where exactly.
///
/// Each candidate is first compared with the depths at some points only, and moved a little if it agrees better there;
/// the best ones at each place are refined and verified, until one is sure. Of all that are probable enough, that which
/// explains most comes first; another one that has too few pixels of its own left is dropped.
///
/// Memory is kept from frame to frame. For one thread at a time.
class ObjectRecognizer
{
public:
  /// Throws std::invalid_argument for a parameter out of range.
  explicit ObjectRecognizer(const RecognizerParams& params = RecognizerParams(),
                            const RefinerParams& refiner = RefinerParams(),
                            const VerifierParams& verifier = VerifierParams(),
                            const DepthErrorParams& errors = DepthErrorParams());
  ~ObjectRecognizer();

  /// Adds a model, whose index is returned: 0, 1, ... Throws std::invalid_argument for none.
  int add(std::shared_ptr<const ObjectShape> shape);

  /// Throws std::invalid_argument if nothing was set in the frame, and for a candidate of no model or whose pose is not
  /// that of a rigid body.
  Recognition recognize(const RecognitionFrame& frame, const std::vector<PoseCandidate>& candidates);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace robot_vision
