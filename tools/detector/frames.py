"""Frames of the room, and which frames of all scenes the network is never shown in training."""

from typing import Iterator, List, NamedTuple, Optional

import numpy as np

from robot_vision import Scene, SceneParams

from .geometry import rectangle, transformed
from .patterns import poster
from .things import Thing, things_of

WIDTH, HEIGHT = 640, 480  # px
RATE = 30  # frames in a second of the motion
PERIOD = 20  # s, after which it repeats
HELD_OUT = 5  # of so many seconds of the period the last one is not shown in training


class Frame(NamedTuple):
    """A frame of a scene, and what is in it."""

    image: np.ndarray  # (height, width, 3) uint8, BGR
    things: List[Thing]
    view: np.ndarray  # the outline of what the image shows, px


def room(seed: int, wall: Optional[np.ndarray], noise: float = 1.0) -> Scene:
    """The room with an image on its wall, or with its own pattern."""
    params = SceneParams()
    params.width, params.height, params.rate = WIDTH, HEIGHT, RATE
    params.seed, params.noise = seed, noise
    return Scene(params, wall)


def is_held_out(number: int) -> bool:
    """Whether a frame is kept for tests."""
    return number // RATE % HELD_OUT == HELD_OUT - 1


def frame_of(scene: Scene, number: int) -> Frame:
    """A frame of a scene with its things."""
    image = scene.render(number)
    return Frame(image, things_of(scene.truth(number)), rectangle(WIDTH, HEIGHT))


def frames_of(
    scene: Scene, count: int, held_out: bool, rng: np.random.Generator
) -> Iterator[Frame]:
    """Frames of a scene by chance, of those kept for tests or of the others."""
    numbers = [n for n in range(RATE * PERIOD) if is_held_out(n) == held_out]
    for number in rng.choice(numbers, count, replace=False):
        yield frame_of(scene, int(number))


def room_album(seed: int, scenes: int, frames: int, held_out: bool) -> List[Frame]:
    """Frames of rooms with different images on the wall; every fourth room has its own pattern."""
    result: List[Frame] = []
    for number in range(scenes):
        rng = np.random.default_rng([seed, number])
        wall = None if number % 4 == 0 else poster(rng)
        scene = room(int(rng.integers(2**31)), wall, rng.uniform(0, 3))
        result.extend(frames_of(scene, frames, held_out, rng))
    return result


def moved(things: List[Thing], matrix: np.ndarray) -> List[Thing]:
    """The things where a matrix takes them; see geometry.transformed."""
    return [
        thing._replace(
            outline=transformed(thing.outline, matrix), extent=transformed(thing.extent, matrix)
        )
        for thing in things
    ]
