"""What hostile hands can reach in Python: messages and files, without a ROS master."""

import io
import re
from typing import Dict, List, Type

import cv2
import genpy
import numpy as np
import rosbag
import rospy
from geometry_msgs.msg import Point32
from networks_to_open import CaffeModels, DarknetModels, OnnxEdits, OnnxModels
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, RegionOfInterest
from streams_to_show import Clouds, CompressedStreams, Requests
from target import Files, Target

from robot_vision import (
    CameraModel,
    HsvRange,
    LocatorParams,
    ObjectTracker,
    RegionLocator,
    TextureMatcher,
    TextureModel,
    TextureParams,
    TextureTrainer,
)
from robot_vision.camera.camera_list import parse_cameras
from robot_vision.color.color_file import save_colors
from robot_vision.common.image_files import sensor_pixels, upright
from robot_vision.common.yaml_text import load_yaml
from robot_vision.depth.detection_places import detection_3d, located, misfit
from robot_vision.depth.places import frame_ids
from robot_vision.faces.face_cache import read_faces, write_faces
from robot_vision.faces.face_images import SIDE, check_box, cut_out
from robot_vision.meshes import Mesh, MeshRenderer, read_mesh, write_mesh
from robot_vision.msg import Detection, DetectionArray
from robot_vision.recordings.bag_images import images_on, opened, topics_of
from robot_vision.recordings.gray_images import gray_file, gray_message
from robot_vision.ros.camera_info import camera_model, image_size
from robot_vision.tags.bundle_files import parse_bundles
from robot_vision.tracking.auto_selection import AutoSelection
from robot_vision.transport import Frame

REFUSALS = (ValueError, OSError, genpy.DeserializationError)
LONGEST_ERROR = 2000  # letters; parsers of YAML say where and why
HIGHEST = 2**32 - 1

rng = np.random.RandomState(1)
IMAGE = rng.randint(0, 256, (12, 16, 3), np.uint8)


def encoded(*suffixes: str) -> List[bytes]:
    return [cv2.imencode(suffix, IMAGE)[1].tobytes() for suffix in suffixes]


def serialized(message: genpy.Message) -> bytes:
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


class Images(Target):
    """Files that are decoded: ~detect, galleries, calibration, pick_color."""

    def seeds(self) -> List[bytes]:
        return encoded(".png", ".jpg", ".bmp", ".ppm", ".webp", ".tiff", ".ras")

    def run(self, data: bytes) -> None:
        sensor_pixels(data)
        upright(data)
        gray_file(data)


class Messages(Target):
    """sensor_msgs/Image and CompressedImage as the tools read them, from bags and topics."""

    def seeds(self) -> List[bytes]:
        image = Image(encoding="bgr8", width=16, height=12, step=48, data=IMAGE.tobytes())
        wide = Image(encoding="mono16", width=8, height=12, step=48, data=IMAGE.tobytes())
        packed = [
            CompressedImage(format="bgr8; jpeg compressed bgr8", data=data)
            for data in encoded(".png", ".jpg")
        ]
        return [b"i" + serialized(one) for one in (image, wide)] + [
            b"c" + serialized(one) for one in packed
        ]

    def run(self, data: bytes) -> None:
        gray_message((Image() if data[:1] == b"i" else CompressedImage()).deserialize(data[1:]))


class CameraInfos(Target):
    """The camera of a topic, which poses and positions are computed with."""

    def seeds(self) -> List[bytes]:
        matrix = [500.0, 0, 8, 0, 500, 6, 0, 0, 1]
        bends = (("plumb_bob", [0.1] * 5), ("equidistant", [0.1] * 4))
        return [
            serialized(CameraInfo(width=16, height=12, K=matrix, D=bend, distortion_model=model))
            for model, bend in bends
        ]

    def run(self, data: bytes) -> None:
        info = CameraInfo().deserialize(data)
        camera = camera_model(info, image_size(info))
        pixels, _ = camera.project(np.array([[0.0, 0.0, 1.0], [0.1, 0.1, 1.0]]))
        assert np.isfinite(camera.K).all() and not np.isnan(pixels[0]).any(), pixels


class Detections(Target):
    """Boxes that others have found, and that faces are cut out of."""

    def seeds(self) -> List[bytes]:
        box = RegionOfInterest(x_offset=2, y_offset=2, width=8, height=8)
        found = [Detection(label="face", id=number, box=box) for number in range(3)]
        return [serialized(DetectionArray(width=16, height=12, detections=found))]

    def run(self, data: bytes) -> None:
        message = DetectionArray().deserialize(data)
        for found in message.detections:
            box = found.box.x_offset, found.box.y_offset, found.box.width, found.box.height
            check_box(IMAGE, box)
            cut_out(IMAGE, box)


class Places(Target):
    """What others have found, and where that is by a depth image."""

    def __init__(self) -> None:
        depth = np.random.RandomState(3).uniform(-0.5, 3.0, (12, 16))
        self._depth = depth.astype(np.float32)
        camera = CameraModel(16, 12, [[15.0, 0.0, 7.5], [0.0, 15.0, 5.5], [0.0, 0.0, 1.0]])
        self._locators = []
        for shape in ("surface", "sphere"):
            params = LocatorParams()
            params.shape, params.min_pixels = shape, 3
            self._locators.append(RegionLocator(camera, params))

    def seeds(self) -> List[bytes]:
        found = []
        for number in range(3):
            box = RegionOfInterest(x_offset=2, y_offset=2, width=8 + number, height=8)
            outline = [Point32(x, y, 0.0) for x, y in ((2, 2), (9, 3), (5, 9))][: 3 * (number % 2)]
            values = {"score": 0.5, "outline": outline, "circle_radius": 2.0 * number}
            found.append(Detection(label="face", id=number, box=box, **values))
        return [serialized(DetectionArray(width=16, height=12, detections=found))]

    def run(self, data: bytes) -> None:
        message = DetectionArray().deserialize(data)
        misfit(message, Frame(self._depth, "32FC1", message.header), "eye")
        names = frame_ids(message.detections, "")
        for found, name in zip(message.detections, names):
            for locator in self._locators:
                place = located(locator, self._depth, found)
                if place is not None:
                    made = detection_3d(found, place, name)
                    assert np.isfinite(made.pose.covariance).all() and made.pixels >= 3
                    assert np.isfinite([made.size.x, made.pose.pose.position.z, made.score]).all()
                    serialized(made)


class Selections(Target):
    """Boxes that others have found, and that object_tracker follows by itself."""

    def __init__(self) -> None:
        rospy.rostime.set_rostime_initialized(True)  # for what it logs, now and then
        self._image = np.random.RandomState(2).randint(0, 256, (96, 128, 3), np.uint8)

    def seeds(self) -> List[bytes]:
        boxes = [RegionOfInterest(x, 20, 50, 50, False) for x in (10, 70)]
        found = [Detection(label="face", id=-1, box=box, score=0.5) for box in boxes]
        message = DetectionArray(width=128, height=96, detections=found)
        message.header.stamp = genpy.Time(1, 0)
        return [serialized(message)]

    def run(self, data: bytes) -> None:
        message = DetectionArray().deserialize(data)
        tracker = ObjectTracker()
        selection = AutoSelection(tracker)
        selection.configure("", 3, 0.0)
        for _ in range(2):  # in the second frame it is what was there before
            tracks = tracker.update(1.0, self._image)
            selection.add(message)
            selection.select(Frame(self._image, "bgr8", message.header), tracks)
        followed = tracker.objects()
        assert len(followed) <= 3 and all(np.isfinite(one.outline).all() for one in followed)


class Cameras(Target):
    """The list of cameras.launch, from its file to the parameters of each camera."""

    def seeds(self) -> List[bytes]:
        return [
            b"cameras:\n- {name: front, source: /dev/video0, rate: 15}\n"
            b"- {name: rear, source: a.mp4, camera_frame_id: eye, framerate: 5.0}\n",
            b"cameras: [{name: a, source: synthetic}]\n",
            b"cameras:\n- name: a\n  source: b\n",
            b"cameras:\n- source: '1'\n  name: 'a'\n",
        ]

    def run(self, data: bytes) -> None:
        values = load_yaml(data.decode())
        cameras = parse_cameras(values.get("cameras") if isinstance(values, dict) else values)
        for name, parameters in cameras.items():
            assert re.fullmatch("[A-Za-z0-9_]+", name) and isinstance(parameters["source"], str)


class Colors(Files):
    """A YAML file that a color is saved into."""

    def seeds(self) -> List[bytes]:
        return [
            b"colors:\n  red: {low: [0, 100, 100], high: [10, 255, 255]}  # as seen\ngain: 1.5\n",
            b"colors: {red: {low: [0, 1, 2], high: [3, 4, 5]}}\n",
            b"# none yet\ngain: 1.5\n",
        ]

    def read(self) -> None:
        save_colors(self.path, {"red": HsvRange((1, 2, 3), (4, 5, 6))})


class Bundles(Target):
    """Bundles of tags in YAML."""

    def seeds(self) -> List[bytes]:
        tag = "{id: %d, size: 0.1, x: 0, y: 0, z: %d, qw: 1, qx: 0, qy: 0, qz: 0}"
        layout = ", ".join(tag % (number, number) for number in range(3))
        return [f"- name: box\n  layout: [{layout}]\n".encode()]

    def run(self, data: bytes) -> None:
        parse_bundles(load_yaml(data.decode()))


class Faces(Files):
    """What a gallery keeps of the faces in its images."""

    def seeds(self) -> List[bytes]:
        write_faces(self.path, {"0" * 64: np.zeros((SIDE, SIDE), np.uint8)})
        with open(self.path, "rb") as file:
            return [file.read()]

    def read(self) -> None:
        read_faces(self.path)


class Meshes(Files):
    """Mesh files of some formats, which the first byte chooses."""

    FORMATS = ("ply", "stl", "obj", "gltf")
    GLTF = (
        b'{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],'
        b'"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"bufferView":0,'
        b'"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],'
        b'"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,'
        b'"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAA'
        b'AA"}]}'
    )

    def seeds(self) -> List[bytes]:
        mesh = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3]])
        found = []
        for number, suffix in enumerate(self.FORMATS[:3]):
            write_mesh(f"{self.path}.{suffix}", mesh)
            with open(f"{self.path}.{suffix}", "rb") as file:
                found.append(bytes([number]) + file.read())
        return [*found, b"\3" + self.GLTF]

    def run(self, data: bytes) -> None:
        path = f"{self.path}.{self.FORMATS[data[0] % len(self.FORMATS)] if data else 'stl'}"
        with open(path, "wb") as file:
            file.write(data[1:])
        try:
            loaded = read_mesh(path)
        except REFUSALS as error:
            assert path in str(error), error
            raise
        for sentence in (loaded.unit_reason, *loaded.warnings):
            assert sentence.isprintable(), sentence
        extent = MeshRenderer(loaded.mesh).extent
        assert 0.0 < extent.diameter < 6.0 and np.isfinite(loaded.mesh.normals).all()


class Textures(Target):
    """What was learned of an object's texture, in a database of others."""

    def __init__(self) -> None:
        size = 96
        self._image = cv2.resize(IMAGE, (size, size), interpolation=cv2.INTER_CUBIC)
        matrix = [[90.0, 0.0, 47.5], [0.0, 90.0, 47.5], [0.0, 0.0, 1.0]]
        self._camera = CameraModel(size, size, matrix)
        self._depth = np.full((size, size), 0.5, np.float32)

    def seeds(self) -> List[bytes]:
        pose = np.eye(4)
        pose[2, 3] = 0.5
        found = []
        for detector in ("orb", "akaze"):
            params = TextureParams()
            params.detector, params.view_features, params.scales = detector, 50, 1
            trainer = TextureTrainer(params, (0.0, 0.0, 0.0), (0.5, 0.5, 0.1))
            trainer.add(self._image, self._depth, None, self._camera, pose)
            found.append(trainer.state().to_bytes())
        return found

    def run(self, data: bytes) -> None:
        model = TextureModel.from_bytes(data)
        matcher = TextureMatcher()
        matcher.add(model)
        for one in matcher.match(self._image, self._depth, self._camera):
            assert 0.0 <= one.probability <= 1.0 and np.isfinite(one.pose).all()


class Bags(Files):
    """A recording, some of whose stamps are the last that there is."""

    def seeds(self) -> List[bytes]:
        with rosbag.Bag(self.path, "w") as bag:
            for number, stamp in enumerate((genpy.Time(1, 0), genpy.Time(HIGHEST, 999999999))):
                image = Image(encoding="mono8", width=4, height=4, step=4, data=bytes(16))
                image.header.stamp, image.header.seq = stamp, number
                bag.write("/image", image, stamp)
        with open(self.path, "rb") as file:
            return [file.read()]

    def read(self) -> None:
        try:
            with opened(self.path) as bag:
                topics_of(bag)
                images = [read for _, read in images_on(bag, "/image")]
        except REFUSALS as error:
            assert self.path in str(error), error
            raise
        for read in images:
            read()


TARGETS: Dict[str, Type[Target]] = {
    "bags": Bags,
    "bundles": Bundles,
    "camera_infos": CameraInfos,
    "caffe_models": CaffeModels,
    "cameras": Cameras,
    "clouds": Clouds,
    "colors": Colors,
    "compressed_streams": CompressedStreams,
    "darknet_models": DarknetModels,
    "detections": Detections,
    "faces": Faces,
    "images": Images,
    "meshes": Meshes,
    "messages": Messages,
    "onnx_edits": OnnxEdits,
    "onnx_models": OnnxModels,
    "places": Places,
    "requests": Requests,
    "selections": Selections,
    "textures": Textures,
}
