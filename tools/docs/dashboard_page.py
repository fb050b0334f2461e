"""The dashboard's page with nodes of the demo, as a browser shows it."""

import contextlib
import re
from typing import Set

import cv2
import numpy as np
from stage import Stage, browser, color, listening, support

from robot_vision.msg import GroundTruth

WIDE = 1280, 720  # px, of the window
PHONE = 390, 844  # CSS px
PHONE_SCALE = 2  # px of the screen for one of CSS
FRAMERATE = 8  # Hz: enough to be seen, and little for nodes and browser on two cores
CAMERA = "/usb_cam"
NODES = (
    ("camera_node", "usb_cam", "_source:=synthetic", "_poster:=auto", f"_framerate:={FRAMERATE}"),
    ("hsv_tracker.py", "hsv_tracker"),
    ("ball_tracker.py", "ball_tracker", "_ball_diameter:=0.2"),
    ("face_detector.py", "face_detector"),
    ("line_follower.py", "line_follower", *color("black")),
    ("code_reader.py", "code_reader"),
    ("apriltag_detector.py", "apriltag_detector", "_tag_size:=0.24"),
    ("edge_detector_node", "edge_detector"),
)
SEEN = {"ball", "box", "tag_0", "tag_1", "qr_code", "poster"}  # in the moment that is shown
DRAWN = 30  # frames of each image, after which all nodes have found what they look for
READY = f"""robotVision.tiles.list().length >= {len(NODES)} &&
  robotVision.tiles.list().every((one) => one.view.drawn || !one.onScreen) &&
  Number(document.body.dataset.frames) > {DRAWN * len(NODES)}"""


def names(truth: GroundTruth) -> Set[str]:
    return {one.name for one in truth.objects if one.visible}


def shown(stage: Stage, scheme: str, phone: bool = False) -> np.ndarray:
    """What a window shows, (height, width, 3) BGR, dark or light."""
    with contextlib.ExitStack() as stack:
        for program, name, *words in NODES:
            stack.enter_context(stage.node(program, name, f"image:={CAMERA}/image_raw", *words))
        dashboard = stack.enter_context(stage.node("dashboard.py", "dashboard"))
        dashboard.wait_for_output("dashboard: http://")
        address = re.search(r"dashboard: (http://\S+)", dashboard.output())[1]
        truths = stack.enter_context(listening(f"{CAMERA}/ground_truth", GroundTruth))
        folder = stage.folder / f"browser_{scheme}_{phone}"
        folder.mkdir()
        driven = stack.enter_context(browser.running(folder))
        page = driven.page()
        page.scheme(scheme)
        page.size(*(PHONE if phone else WIDE), phone, PHONE_SCALE if phone else 1)
        page.open(address)
        page.wait(READY, seconds=3 * support.DEADLINE)
        support.wait_for(lambda: names(truths.received[-1]) >= SEEN, "all that is to be seen")
        return page.screenshot()


def dark(stage: Stage) -> np.ndarray:
    return shown(stage, "dark")


def light(stage: Stage) -> np.ndarray:
    return shown(stage, "light")


def phone(stage: Stage) -> np.ndarray:
    image = shown(stage, "dark", phone=True)
    size = PHONE[0] * 3 // 2, PHONE[1] * 3 // 2
    return cv2.resize(image, size, interpolation=cv2.INTER_AREA)
