"""Draws keypoints, matches and the reference that is found."""

import numpy as np

from .. import KeypointMatches, Keypoints, draw_outline
from ..common import opencv as cv2
from ..common.drawing import FRACTION_BITS, fixed_point
from ..common.plain_text import to_ascii

# BGR, and what they show.
YELLOW, GREEN, RED = (0, 255, 255), (0, 255, 0), (0, 0, 255)  # keypoints, inliers, other matches
MAX_DRAWN = 1e5  # px from the image: OpenCV's fixed-point numbers end there


def draw_keypoints(image: np.ndarray, found: Keypoints) -> None:
    """Draws a circle of its size for each keypoint, with its direction if it has one."""
    degrees = np.where(found.angles < 0.0, -1.0, np.rad2deg(found.angles))
    values = np.column_stack([found.points, found.sizes, degrees]).tolist()
    keypoints = [cv2.KeyPoint(*numbers) for numbers in values]  # their names differ by version
    cv2.drawKeypoints(image, keypoints, image, YELLOW, cv2.DRAW_MATCHES_FLAGS_DRAW_RICH_KEYPOINTS)


def draw_reference(image: np.ndarray, found: KeypointMatches, label: str) -> None:
    """Draws the inliers and the outline of a reference that was found."""
    for x, y in np.rint(found.points[found.inliers]).astype(int).tolist():
        cv2.circle(image, (x, y), 3, GREEN, cv2.FILLED)
    if found.pose and np.abs(found.pose.outline).max() < MAX_DRAWN:
        share = f"{found.inliers.sum()} of {len(found)}"
        outline = np.rint(found.pose.outline).astype(int)
        draw_outline(image, outline, f"{to_ascii(label)}: {share}", GREEN)


def draw_motion(image: np.ndarray, found: KeypointMatches) -> None:
    """Draws a line from where each point was in the last frame to where it is in this one."""
    ends = fixed_point(np.hstack([found.reference_points, found.points]))
    for (x0, y0, x1, y1), inlier in zip(ends.tolist(), found.inliers.tolist()):
        tone = GREEN if inlier else RED
        cv2.line(image, (x0, y0), (x1, y1), tone, 1, cv2.LINE_AA, FRACTION_BITS)
        cv2.circle(image, (x1, y1), 2 << FRACTION_BITS, tone, -1, cv2.LINE_AA, FRACTION_BITS)
