"""Depth images: into another camera, as points, normals, planes, tables and places, without ROS.

Depths are (height, width) arrays of uint16 in mm, 0 where there is none, or of float32 in m, NaN
where there is none (REP 118).

>>> from robot_vision import depth
>>> registered = depth.register(image, depth_camera, color_camera, depth_to_color)
>>> xyz = depth.points(registered, color_camera)
>>> (table, *_), labels = depth.tables(image, depth_camera, up=(0, -1, 0))
>>> face = depth.locate(registered, color_camera, box=(310, 120, 60, 60))
"""

from typing import Any, List, Optional, Sequence, Tuple

import numpy as np

from .. import (
    CameraModel,
    DepthErrorParams,
    DepthNormals,
    DepthPoints,
    DepthRegistration,
    LocatedRegion,
    LocatorParams,
    NormalParams,
    Plane,
    PlaneFinder,
    PlaneParams,
    RegionLocator,
    RegistrationParams,
    Table,
    TabletopFinder,
    TabletopParams,
    odd_depth,
    to_metres,
    to_millimetres,
)
from ..common.params import with_values

__all__ = [
    "locate",
    "normals",
    "odd_depth",
    "planes",
    "points",
    "register",
    "tables",
    "to_metres",
    "to_millimetres",
]

# Each of these functions makes what it needs anew. For a stream of images use the classes of
# robot_vision that they are made of, which keep their tables and their memory.


def register(
    image: np.ndarray,
    depth_camera: CameraModel,
    color_camera: CameraModel,
    depth_to_color: np.ndarray,
    **values: Any,
) -> np.ndarray:
    """The depth of each pixel of a color camera, of the type of `image`.

    `values` are RegistrationParams by their names: max_jump=0.1.

    Args:
        depth_to_color: 4x4, takes points (m) of the depth camera's optical frame to that of the
            color camera.

    Raises:
        ValueError: An image, a parameter or the matrix cannot be used.
        AttributeError: There is no such parameter.
    """
    params = with_values(RegistrationParams(), values)
    return DepthRegistration(depth_camera, color_camera, depth_to_color, params).apply(image)


def points(image: np.ndarray, camera: CameraModel) -> np.ndarray:
    """x, y and z of each pixel in the optical frame, (height, width, 3) float32, m; NaN: none."""
    return DepthPoints(camera).points(image)


def normals(image: np.ndarray, camera: CameraModel, **values: Any) -> np.ndarray:
    """Unit vectors to the camera's side of surfaces, (height, width, 3) float32; NaN: none.

    `values` are NormalParams by their names: radius=3. Raises as register() does.
    """
    return DepthNormals(camera, with_values(NormalParams(), values)).apply(image)


def planes(image: np.ndarray, camera: CameraModel, **values: Any) -> Tuple[List[Plane], np.ndarray]:
    """The planes, the one with most pixels first, and (height, width) uint8.

    The array is 1 for pixels of the first plane, 2 of the second, ...; 0 of none. `values` are
    PlaneParams by their names: noise=0.004. Raises as register() does.
    """
    return PlaneFinder(camera, with_values(PlaneParams(), values)).find(image)


def tables(
    image: np.ndarray,
    camera: CameraModel,
    up: Optional[Sequence[float]] = None,
    plane_params: Optional[PlaneParams] = None,
    **values: Any,
) -> Tuple[List[Table], np.ndarray]:
    """The tables with what stands on them, the highest first, and (height, width) uint16.

    The array is 1 for pixels of the first object of all tables, 2 of the second, ...; 0 of none.
    `values` are TabletopParams by their names: min_height=0.02. Raises as register() does.

    Args:
        up: What is up in the camera's optical frame; None: the largest plane is the table.
    """
    params = with_values(TabletopParams(), values)
    finder = TabletopFinder(camera, plane_params or PlaneParams(), params)
    return finder.find(image, (0.0, 0.0, 0.0) if up is None else up)


def locate(
    image: np.ndarray,
    camera: CameraModel,
    box: Tuple[int, int, int, int],
    outline: Optional[np.ndarray] = None,
    center: Optional[Tuple[float, float]] = None,
    radius: float = 0.0,
    errors: Optional[DepthErrorParams] = None,
    **values: Any,
) -> Optional[LocatedRegion]:
    """Where a thing is that was found in the image of a camera; None if too few of it have a depth.

    `values` are LocatorParams by their names: shape="sphere". Raises as register() does.

    Args:
        image: The depths of that camera's image: those of a color camera are registered to it.
        box: (x, y, width, height), px.
        outline: (n, 2), px, a closed polygon; None: all of the box.
        center: (x, y), px; None: the middle of the box.
        radius: Of a sphere, px; 0: that of the box.
        errors: How wrong the depths are; None: those of a Kinect.
    """
    params = with_values(LocatorParams(), values)
    locator = RegionLocator(camera, params, errors or DepthErrorParams())
    return locator.locate(image, box, outline, center, radius)
