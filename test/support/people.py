"""Photographs of people that differ in position, size, light, angle and noise."""

import functools

import cv2
import numpy as np
import skimage.data

SIZE = 320, 240  # px
# Faces of 25x25 px in scikit-image's lfw_subset, all of different people.
ANNA, BERT, CARLA, DORA = 18, 3, 52, 25
KNOWN = (ANNA, BERT, 5, 6, 8, 15, 19, 23, 34, 40)
STRANGERS = (CARLA, DORA, 46, 61, 66, 71, 74, 80, 91, 90)


@functools.lru_cache(maxsize=None)
def looks():
    """Faces of 100 people, (100, 25, 25), 0 to 1."""
    return skimage.data.lfw_subset()[:100]


def photograph(person, number):
    """An image, (240, 320, 3) uint8 BGR, and the box of its head: x, y, width, height."""
    random = np.random.default_rng(1000 * person + number)
    side = int(random.integers(110, 170))
    x, y = (np.array(SIZE) - side) / 2 + random.uniform((-30, -20), (30, 20))
    look = looks()[person].astype(np.float32)
    look = cv2.resize(look, (side, side), interpolation=cv2.INTER_CUBIC).clip(0, 1)
    turn = cv2.getRotationMatrix2D((side / 2, side / 2), random.uniform(-6, 6), 1.0)
    turn[:, 2] += x, y
    scene = cv2.warpAffine(look, turn, SIZE, borderMode=cv2.BORDER_REPLICATE)
    shade = 1 + random.uniform(-0.25, 0.25) * np.linspace(-1, 1, SIZE[0])
    scene = 255 * scene ** random.uniform(0.7, 1.4) * random.uniform(0.7, 1.1) * shade
    noise = random.normal(0, random.uniform(1, 4), scene.shape)
    gray = np.clip(scene + noise, 0, 255).astype(np.uint8)
    return cv2.cvtColor(gray, cv2.COLOR_GRAY2BGR), (round(x), round(y), side, side)


def photographs(person, count, first=0):
    """Several photographs, as Gallery.add() takes them."""
    return {f"{person}/{n}": photograph(person, n)[0] for n in range(first, first + count)}
