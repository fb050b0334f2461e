"""The images of the page of object recognition: by its commands, and by the node itself."""

import contextlib
import pathlib

import cv2
import numpy as np
from canvas import beside
from sensor_msgs.msg import Image
from stage import Stage, listening, pixels, support

from robot_vision.meshes import MeshRenderer, sample_mesh
from robot_vision.recognition.database import Database
from robot_vision.recognition.mesh_data import unpack_mesh
from robot_vision.recognition.observed_views import seen_by

CAMERA = "_source:=synthetic", "_views:=rgbd", "_scene:=tabletop", "_depth_noise:=kinect"
REGISTRATION = (
    "depth/image_raw:=/camera/depth/image_raw",
    "rgb/image_raw:=/camera/rgb/image_raw",
    "depth_registered/image_raw:=/camera/depth_registered/image_raw",
    "depth_registered/camera_info:=/camera/depth_registered/camera_info",
)


def run(stage: Stage, program: str, *words: str) -> None:
    process = stage.start(program, *words)
    if process.exit_code() != 0:
        raise RuntimeError(f"{process}:\n{process.output()}")


def learned(stage: Stage) -> pathlib.Path:
    """A database of all samples, which is made once."""
    path = stage.folder / "objects.db"
    if path.exists():
        return path
    run(stage, "learn_samples.py", "--database", str(path))
    return path


def recognition(stage: Stage) -> np.ndarray:
    """The things on the table, and their meshes drawn over the image."""
    topics = "/camera/rgb/image_raw", "/object_recognizer/processed_image"
    inputs = "image:=/camera/rgb/image_raw", "depth:=/camera/depth_registered/image_raw"
    words = f"_database:={learned(stage)}", "_on_tables:=true"
    with contextlib.ExitStack() as stack:
        stack.enter_context(stage.node("camera_node", "camera", *CAMERA))
        registration = stage.node("depth_registration_node", "depth_registration", *REGISTRATION)
        stack.enter_context(registration)
        node = stage.node("object_recognizer.py", "object_recognizer", *inputs, *words)
        stack.enter_context(node)
        sent = [stack.enter_context(listening(topic, Image)) for topic in topics]
        shown = support.same_frame(*sent)
    return beside([pixels(one) for one in shown], ["rgb/image_raw", "~processed_image"])


def mesh_view(stage: Stage) -> np.ndarray:
    """What mesh_view.py writes of an object."""
    path, sheet = learned(stage), stage.folder / "drill.png"
    words = "drill", "--output", str(sheet), "--side", "160", "--database", str(path)
    run(stage, "mesh_view.py", *words)
    return cv2.imread(str(sheet))


def object_capture(stage: Stage) -> np.ndarray:
    """A view of the turntable with what is found to be the object, and the mesh of all views."""
    import turntable  # of the tests, whose folder stage has added to the path

    path = stage.folder / "captured.db"
    database = "--database", str(path)
    run(stage, "object_add.py", "-n", "box", "--commit", *database)
    table = turntable.Turntable(sample_mesh("box").mesh)
    frames = turntable.write_frames(stage.folder / "turn", table.turn(36))
    plate = turntable.write_bundle(stage.folder / "plate.yaml")
    run(stage, "object_capture.py", "box", plate, "--folder", frames, "--commit", *database)
    with Database(str(path)) as opened:
        one = opened.objects.find("box")
        (session,) = opened.observations.sessions(one.id)
        seen = seen_by(opened.observations.of(session.id)[5])
        mesh = unpack_mesh(opened.meshes.converted(one.id))
    outlines = cv2.findContours(seen.mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)[-2]
    cv2.drawContours(seen.image, outlines, -1, (0, 220, 255), 2)
    whole = (0, 0, seen.camera.width, seen.camera.height)
    near = seen.pose.copy()
    middle = near[:3, :3] @ np.mean(mesh.vertices, axis=0) + near[:3, 3]
    near[:3, 3] -= middle * [1.0, 1.0, 0.4]
    view = MeshRenderer(mesh).render(seen.camera.K, near, whole, bgr=True)
    drawn = np.where(np.isfinite(view.depth)[..., None], view.bgr, 255).astype(np.uint8)
    return beside([seen.image, drawn], ["a view, and what is the object", "the mesh of 36 views"])
