"""Images whose segments are known, for the tests of segmentation."""

import cv2
import numpy as np

# Discs that touch their neighbors, and one alone: x, y and radius in px.
DISCS = [(70, 70, 40), (145, 70, 40), (60, 190, 30), (112, 190, 25), (250, 60, 38), (250, 210, 14)]
DISC_IMAGE = 300, 250  # px, width and height
PAPER, INK = (40, 60, 50), (60, 180, 220)  # BGR


def discs(noise=0.0, swap=False):
    """Bright discs on a dark ground, or the other way round, and which disc each pixel is of.

    Of two discs a pixel belongs to the one whose outline it is farther inside of; -1: to none.
    """
    width, height = DISC_IMAGE
    y, x = np.mgrid[:height, :width]
    outside = np.stack([np.hypot(x - cx, y - cy) - radius for cx, cy, radius in DISCS])
    owner = np.where(outside.min(axis=0) <= 0.0, outside.argmin(axis=0), -1)
    ground, ink = (INK, PAPER) if swap else (PAPER, INK)
    image = np.where((owner >= 0)[..., None], ink, ground)
    grain = np.random.default_rng(1).normal(0.0, noise, image.shape)
    return np.clip(image + grain, 0, 255).astype(np.uint8), owner


def leaf(seed=0):
    """A red leaf before a texture of other colors, its mask, and a rectangle around it."""
    random = np.random.default_rng(seed)
    coarse = random.integers(40, 200, (15, 20, 3)).astype(np.uint8)
    coarse[..., 2] //= 2
    image = cv2.resize(coarse, (160, 120), interpolation=cv2.INTER_CUBIC)
    mask = np.zeros((120, 160), np.uint8)
    cv2.ellipse(mask, (80, 60), (42, 26), 20, 0, 360, 255, -1)
    red = random.normal((60, 70, 150), 25, image.shape)
    image = np.where(mask[..., None] > 0, np.clip(red, 0, 255), image).astype(np.uint8)
    image = cv2.GaussianBlur(image, (0, 0), 1.5) + random.normal(0.0, 8.0, image.shape)
    image = np.clip(image, 0, 255).astype(np.uint8)
    return image, mask > 0, (28, 20, 104, 82)


def patches(noise=4.0, seed=0):
    """Three colors with noise in bands of 60, 40 and 20 columns, and the colors."""
    colors = np.array([(30, 60, 200), (200, 120, 40), (90, 220, 120)], float)
    columns = np.repeat(np.arange(3), (60, 40, 20))
    image = np.repeat(colors[columns][None], 90, axis=0)
    image += np.random.default_rng(seed).normal(0.0, noise, image.shape)
    return np.clip(np.rint(image), 0, 255).astype(np.uint8), colors, columns


def steps():
    """Gray bands of 16 columns, 100 to 142 in steps of 6, which a black line divides in two."""
    image = np.repeat(100 + 6 * (np.arange(128) // 16), 3).reshape(1, 128, 3)
    image = np.repeat(image, 60, axis=0).astype(np.uint8)
    image[30] = 0
    return image
