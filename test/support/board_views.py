"""Shared by the tests of calibration: images of boards, and views of them by a camera."""

import cv2
import numpy as np

import robot_vision as rv

SQUARE = 0.03  # m, also the distance of circles
DOT = 40  # px per square in the image of a board
MARKER = 0.022  # m
BLACK, WHITE = 30, 230


def chessboard(columns, rows):
    """A gray image with this many inner corners; a square is DOT px, the margin half a square."""
    squares = np.indices((rows + 1, columns + 1)).sum(axis=0) % 2
    return framed(np.kron(np.where(squares, WHITE, BLACK), np.ones((DOT, DOT))))


def circles(columns, rows):
    return dotted([(x, y) for y in range(rows) for x in range(columns)], columns, rows)


def asymmetric_circles(columns, rows):
    points = [(2 * x + y % 2, y) for y in range(rows) for x in range(columns)]
    return dotted(points, 2 * columns, rows)


def charuco(columns, rows, dictionary, first=BLACK):
    """A board whose upper left square is `first`: OpenCV before 4.6 has white for even rows."""
    side = round(DOT * MARKER / SQUARE)
    margin = (DOT - side) // 2
    whites = np.indices((rows, columns)).sum(axis=0) % 2 == (first == BLACK)
    image = np.kron(np.where(whites, WHITE, BLACK), np.ones((DOT, DOT)))
    for number, (y, x) in enumerate(np.argwhere(whites) * DOT + margin):
        image[y : y + side, x : x + side] = marker(number, dictionary, side)
    return framed(image)


def marker(number, dictionary, side):
    aruco = cv2.aruco
    words = aruco.getPredefinedDictionary(getattr(aruco, "DICT_" + dictionary.upper()))
    draw = aruco.generateImageMarker if hasattr(aruco, "generateImageMarker") else aruco.drawMarker
    return np.where(draw(words, number, side), WHITE, BLACK)


def dotted(points, columns, rows):
    image = np.full((rows * DOT, columns * DOT), WHITE, np.uint8)
    for x, y in points:
        middle = (DOT * x + DOT // 2) * 16 - 8, (DOT * y + DOT // 2) * 16 - 8
        cv2.circle(image, middle, DOT * 16 * 3 // 10, BLACK, -1, cv2.LINE_AA, 4)
    return framed(image)


def framed(image):
    return np.pad(np.uint8(image), DOT // 2, constant_values=WHITE)


class Studio:
    """A camera to which a board is shown: each frame another pose, with the whole board in view.

    The image of the board is `size` m large; without, a square of it has DOT px and SQUARE m.
    """

    def __init__(self, board, camera, seed=1, size=None):
        size = np.array(board.shape[::-1]) / DOT * SQUARE if size is None else np.array(size)
        self._image = cv2.cvtColor(board, cv2.COLOR_GRAY2BGR), tuple(size)
        self._scene = rv.FloorScene(*self._image, camera)
        self._camera = camera
        self._random = np.random.RandomState(seed)
        x, y = size / 2.0
        self._corners = np.array([[-x, -y, 0.0], [x, -y, 0.0], [x, y, 0.0], [-x, y, 0.0]])
        self._nearest = 0.75 * max(size * camera.K[[0, 1], [0, 1]] / (camera.width, camera.height))

    def frame(self, noise=1.0):
        """The next frame, (height, width) uint8."""
        return self._seen(self._scene, self._pose(), noise)

    def _seen(self, scene, pose, noise):
        on_floor = np.array([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
        gray = cv2.cvtColor(scene.render(np.linalg.inv(pose @ on_floor)), cv2.COLOR_BGR2GRAY)
        noisy = gray + self._random.normal(0.0, noise, gray.shape)
        return np.clip(np.rint(noisy), 0, 255).astype(np.uint8)

    def _pose(self):
        """The pose of the board in the optical frame, 4x4: x right, y up, z towards the camera."""
        random, camera = self._random, self._camera
        while True:
            axis, tilt = random.uniform(0.0, 2.0 * np.pi), random.uniform(0.25, 0.75)
            turn = cv2.Rodrigues(tilt * np.array([np.cos(axis), np.sin(axis), 0.0]))[0]
            roll = cv2.Rodrigues(np.array([0.0, 0.0, random.uniform(-0.4, 0.4)]))[0]
            pose = np.eye(4)
            pose[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ turn @ roll
            pixel = random.uniform((0.0, 0.0), (camera.width, camera.height))
            ray = (pixel - camera.K[:2, 2]) / camera.K[[0, 1], [0, 1]]
            pose[:3, 3] = random.uniform(0.9, 2.0) * self._nearest * np.array([*ray, 1.0])
            if self._is_inside(camera, pose):
                return pose

    def _is_inside(self, camera, pose):
        """Whether the camera has the whole board in view."""
        border = 3.0  # px
        pixels, _ = camera.project(self._corners @ pose[:3, :3].T + pose[:3, 3])
        inside = (pixels > border) & (pixels < [camera.width - border, camera.height - border])
        return bool(inside.all())


class PairStudio(Studio):
    """Two cameras to which a board is shown, in view of both.

    `to_right` is 4x4, and takes points (m) of the left optical frame to that of the right camera.
    """

    def __init__(self, board, left, right, to_right, seed=1):
        super().__init__(board, left, seed)
        self._right = rv.FloorScene(*self._image, right)
        self._right_camera = right
        self._to_right = to_right

    def pair(self, noise=1.0):
        """The next images of both, (height, width) uint8."""
        pose = self._pose()
        while not self._is_inside(self._right_camera, self._to_right @ pose):
            pose = self._pose()
        seen = (self._scene, pose), (self._right, self._to_right @ pose)
        return tuple(self._seen(scene, of, noise) for scene, of in seen)
