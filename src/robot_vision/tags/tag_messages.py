"""Tags as messages, transforms and markers."""

from typing import Iterable, List, Sequence, Tuple

import numpy as np
import rospy
from geometry_msgs.msg import Point, Vector3
from std_msgs.msg import ColorRGBA, Header
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

from ..msg import TagBundlePose, TagDetection, TagDetectionArray
from ..ros.poses import pose_of, transform_of, with_covariance
from .tag_poses import LocatedBundle, LocatedTag

THICKNESS = 0.05  # thickness of a tag's marker, as a share of the tag's side
TEXT_HEIGHT = 0.6  # height of the id on it, as a share of the tag's side
LIFETIME = 0.5  # s for which a marker stays after its tag is gone
BLUE, WHITE = ColorRGBA(0.1, 0.4, 1.0, 0.8), ColorRGBA(1.0, 1.0, 1.0, 1.0)


def tag_array(
    header: Header,
    size: Tuple[int, int],
    tags: Iterable[LocatedTag],
    bundles: Iterable[LocatedBundle],
) -> TagDetectionArray:
    """Returns the tags found in an image of `size`, (width, height) in px, as a message."""
    return TagDetectionArray(
        header=header,
        width=size[0],
        height=size[1],
        detections=[_detection(tag) for tag in tags],
        bundles=[_bundle(bundle) for bundle in bundles],
    )


def transforms(
    header: Header, tags: Sequence[LocatedTag], bundles: Sequence[LocatedBundle]
) -> TFMessage:
    """Returns the transforms of tags and bundles, without tags that are there more than once."""
    known = [(tag.frame_id, tag.poses) for tag in tags if tag.unique and tag.poses]
    known += [(bundle.name, bundle.poses) for bundle in bundles]
    return TFMessage([transform_of(header, name, poses.best.pose) for name, poses in known])


def markers(header: Header, tags: Iterable[LocatedTag]) -> MarkerArray:
    """Returns a flat box and an id for each tag that has a pose."""
    made: List[Marker] = []
    for tag in tags:
        if not tag.poses:
            continue
        side = tag.size
        box = Marker(type=Marker.CUBE, color=BLUE, scale=Vector3(side, side, THICKNESS * side))
        text = Marker(type=Marker.TEXT_VIEW_FACING, color=WHITE, text=str(tag.tag.id))
        text.scale.z = TEXT_HEIGHT * side
        for marker, kind in ((box, ""), (text, " ids")):
            marker.header = header
            marker.ns = tag.tag.family + kind
            # Tags with the same id get different markers.
            marker.id = tag.tag.id if tag.unique else -1 - len(made)
            marker.pose = pose_of(tag.poses.best.pose)
            marker.lifetime = rospy.Duration(LIFETIME)
            made.append(marker)
    return MarkerArray(made)


def _detection(located: LocatedTag) -> TagDetection:
    tag = located.tag
    message = TagDetection(
        family=tag.family,
        id=tag.id,
        frame_id=located.frame_id,
        size=located.size,
        hamming=tag.hamming,
        decision_margin=tag.margin,
        similarity=tag.similarity,
        center=Point(*tag.center, 0.0),
        corners=[Point(x, y, 0.0) for x, y in np.asarray(tag.corners).tolist()],
        has_pose=located.poses is not None,
    )
    if located.poses is not None:
        poses = located.poses
        message.pose = with_covariance(poses.best.pose, poses.best.covariance)
        message.reprojection_error = poses.best.error
        message.probability = poses.probability
        message.error_ratio = poses.ratio
        if poses.other is not None:
            message.has_other_pose = True
            message.other_pose = pose_of(poses.other.pose)
            message.other_reprojection_error = poses.other.error
    return message


def _bundle(bundle: LocatedBundle) -> TagBundlePose:
    best = bundle.poses.best
    return TagBundlePose(
        name=bundle.name,
        family=bundle.family,
        ids=bundle.ids,
        pose=with_covariance(best.pose, best.covariance),
        reprojection_error=best.error,
        probability=bundle.poses.probability,
    )
