"""Nodes on a ROS master of their own, which are shown frames of the scene one after the other."""

import contextlib
import os
import pathlib
import shutil
import sys
from typing import Any, Callable, Iterator, List, Sequence, Tuple, Union

import cv2
import numpy as np
import rospy
import skimage.data
import yaml
from sensor_msgs.msg import CameraInfo, Image

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "test" / "support"))

import browser  # noqa: E402, F401  for those who import this, as the next one
import figures  # noqa: E402, F401  drawn people
import support  # noqa: E402  of the tests of nodes: processes and topics with deadlines

from robot_vision import CalibrationScene, Scene, SceneParams  # noqa: E402

IMAGE = "/usb_cam/image_raw"
BEGIN = 1767268800  # s, of the stamps: noon of a first of January
RATE = 30.0  # Hz, of the frames' own time
NOISE = 0.5  # gray levels: more takes larger files
FRAME = 240  # in which everything can be seen


def room(width: int = 640, height: int = 480, still: bool = False, portrait: bool = True) -> Scene:
    """The synthetic room, with a portrait or a pattern on its wall."""
    params = SceneParams()
    params.width, params.height, params.still, params.noise = width, height, still, NOISE
    poster = cv2.cvtColor(skimage.data.astronaut(), cv2.COLOR_RGB2BGR) if portrait else None
    return Scene(params, poster)


def color(name: str) -> List[str]:
    """The parameters of a file in config/colors, as words of a command line."""
    values = yaml.safe_load((ROOT / "config" / "colors" / f"{name}.yaml").read_text())
    return [f"_{key}:={value}" for key, value in values.items()]


def pixels(message: Image) -> np.ndarray:
    """The image of a message, bgr8 or mono8."""
    rows = np.frombuffer(message.data, np.uint8).reshape(message.height, message.step)
    if message.encoding == "mono8":
        return rows[:, : message.width]
    assert message.encoding == "bgr8", message.encoding
    return rows[:, : 3 * message.width].reshape(message.height, message.width, 3)


class Camera:
    """Publishes frames of a scene, and the camera's calibration beside them."""

    def __init__(self, scene: Union[Scene, CalibrationScene], topic: str = IMAGE):
        self._scene = scene
        self._images = rospy.Publisher(topic, Image, queue_size=10, tcp_nodelay=True)
        info = topic.rpartition("/")[0] + "/camera_info"
        self._infos = rospy.Publisher(info, CameraInfo, queue_size=10, tcp_nodelay=True)
        self._shown = 0

    def wait_for(self, images: int, infos: int = 0) -> None:
        """Until there are so many subscribers."""
        support.wait_for(
            lambda: (
                self._images.get_num_connections() >= images
                and self._infos.get_num_connections() >= infos
            ),
            "subscribers to the frames",
        )

    def show(self, frame: int) -> rospy.Time:
        """Publishes a frame of the scene, a frame later than the last; its stamp."""
        image = self._scene.render(frame)
        message = Image(encoding="bgr8", height=image.shape[0], width=image.shape[1])
        message.step, message.data = 3 * message.width, image.tobytes()
        message.header.stamp = rospy.Time.from_sec(BEGIN + self._shown / RATE)
        message.header.frame_id = "head_camera"
        camera = self._scene.camera
        info = CameraInfo(header=message.header, height=message.height, width=message.width)
        info.distortion_model = camera.distortion_model
        info.K, info.D = np.ravel(camera.K).tolist(), list(camera.D)
        self._shown += 1
        self._infos.publish(info)
        self._images.publish(message)
        return message.header.stamp

    def close(self) -> None:
        self._images.unregister()
        self._infos.unregister()


class Stage:
    """The master, and this process as a node of it.

    Args:
        folder: for logs.
    """

    def __init__(self, folder: pathlib.Path):
        self.folder = folder
        self._started = 0
        self._master = support.Master(self.start)
        os.environ.update(self._master.env, ROS_HOME=str(folder), TZ="UTC")
        rospy.init_node("docs", disable_signals=True, disable_rosout=True)

    def close(self) -> None:
        rospy.signal_shutdown("the images are made")
        self._master.end()

    def start(self, program: str, *arguments: Any) -> support.Process:
        """Starts a program of this package, or one of another path."""
        path = program if "/" in program else support.executable(program)
        log = self.folder / f"{self._started}-{os.path.basename(path)}.log"
        self._started += 1
        return support.Process([path, *map(str, arguments)], log)

    @contextlib.contextmanager
    def node(self, program: str, name: str, *arguments: str) -> Iterator[support.Process]:
        """Runs a node; afterwards the parameter server knows nothing of it."""
        process = self.start(program, f"__name:={name}", *arguments)
        try:
            yield process
        except Exception:
            print(f"{process}:\n{process.output()[-2000:]}", file=sys.stderr)
            raise
        finally:
            process.end()
            if rospy.has_param("/" + name):
                rospy.delete_param("/" + name)

    @contextlib.contextmanager
    def shown(self, scene: Any, topic: str = IMAGE) -> Iterator[Camera]:
        """A camera that shows the scene."""
        camera = Camera(scene, topic)
        try:
            yield camera
        finally:
            camera.close()

    @contextlib.contextmanager
    def watched(
        self,
        program: str,
        scene: Any,
        *arguments: str,
        output: str = "processed_image",
        kind: Any = Image,
        images: int = 1,
        infos: int = 0,
    ) -> Iterator[Callable[[int], Any]]:
        """Runs a node; gives what shows it a frame and returns its answer, the message on `output`.

        Args:
            images: how many subscribe to the frames, for other nodes run already.
            infos: how many subscribe to their camera_info.
        """
        name = program.partition(".")[0].replace("_node", "")
        node = self.node(program, name, f"image:={IMAGE}", *arguments)
        answers = listening(f"/{name}/{output}", kind)
        with self.shown(scene) as camera, node, answers as results:
            camera.wait_for(images, infos)
            yield lambda frame: results.of(camera.show(frame))

    def drawn(
        self, program: str, scene: Any, frames: Sequence[int], *arguments: str, **options: Any
    ) -> np.ndarray:
        """The ~processed_image of a node on the last of these frames; `options` of watched()."""
        with self.watched(program, scene, *arguments, **options) as show:
            return [pixels(show(frame)) for frame in frames][-1]


@contextlib.contextmanager
def listening(topic: str, kind: Any) -> Iterator[support.Messages]:
    """The messages of a topic, once its publisher sends."""
    messages = support.Messages(topic, kind)
    try:
        support.wait_for(messages.connected, topic)
        yield messages
    finally:
        messages.close()


@contextlib.contextmanager
def x_server(stage: Stage, size: Tuple[int, int] = (800, 600)) -> Iterator[pathlib.Path]:
    """A virtual screen of `size` px, which $DISPLAY names meanwhile; its frame buffer's file."""
    screen = "{}x{}x24".format(*size)
    options = ["-displayfd", "1", "-noreset", "-fbdir", stage.folder, "-screen", "0", screen]
    process = stage.start(str(shutil.which("Xvfb")), *options)
    try:
        lines = support.wait_for(
            lambda: [line for line in process.output().split("\n")[:-1] if line.isdigit()],
            "the X server",
        )
        os.environ["DISPLAY"] = ":" + lines[0]
        yield stage.folder / "Xvfb_screen0"
    finally:
        os.environ.pop("DISPLAY", None)
        process.end()
