"""The image of rviz, which has to be installed: sudo apt install rviz."""

import contextlib
import os

import numpy as np
import roslib.packages
from canvas import beside
from pages import RGBD
from stage import ROOT, Stage, support, x_server

SIZE = 1400, 900  # px, of the window, as config/rgbd.rviz has it
DOCKS = 490  # px, width of what stands to the left of the view
NAMES = "_camera_name:=camera", "_camera_frame_id:=camera_rgb_optical_frame"


def shown_share(part: np.ndarray) -> float:
    """The share of pixels that have a color of their own."""
    spread = part.max(axis=2).astype(int) - part.min(axis=2)
    return float((spread > 12).mean())


def rviz(stage: Stage) -> np.ndarray:
    """The scene's colored points, and the images that they are made of."""
    program = roslib.packages.find_node("rviz", "rviz")[0]
    os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"
    with contextlib.ExitStack() as stack:
        screen = stack.enter_context(x_server(stage, SIZE))
        stack.enter_context(stage.node("camera_node", "camera", *RGBD, *NAMES))
        words = "depth_registration_node", "depth_registration", "__ns:=/camera"
        stack.enter_context(stage.node(*words))
        stack.enter_context(stage.node(program, "rviz", "-d", str(ROOT / "config" / "rgbd.rviz")))

        def drawn() -> bool:
            window = support.screen(screen)
            view, docks = window[:, DOCKS:], window[:, :DOCKS]
            return shown_share(view) > 0.1 and shown_share(docks) > 0.15

        support.wait_for(drawn, "points and images in rviz", 2 * support.DEADLINE)
        width, height = SIZE
        return beside([support.screen(screen)[:height, :width].copy()])
