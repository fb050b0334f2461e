"""Colors, blur and noise of images, by chance."""

import cv2
import numpy as np


def recolored(rng: np.random.Generator, image: np.ndarray, strength: float = 1.0) -> np.ndarray:
    """An image with another hue, saturation, gamma and white balance; strength is 0 to 1."""
    hsv = cv2.cvtColor(image, cv2.COLOR_BGR2HSV)
    turn = int(rng.uniform(-90, 90) * strength) if rng.random() < 0.5 else int(rng.normal(0, 5))
    saturation = rng.uniform(1 - 0.8 * strength, 1 + 0.5 * strength)
    if rng.random() < 0.06 * strength:
        saturation = 0.0
    levels = np.arange(256)
    hsv[..., 0] = cv2.LUT(hsv[..., 0], ((levels + turn) % 180).astype(np.uint8))
    hsv[..., 1] = cv2.LUT(hsv[..., 1], np.clip(levels * saturation, 0, 255).astype(np.uint8))
    bgr = cv2.cvtColor(hsv, cv2.COLOR_HSV2BGR)
    gamma = np.exp(rng.normal(0, 0.35 * strength))
    gains = rng.uniform(0.75, 1.1) * (1 + rng.normal(0, 0.06 * strength, 3))
    offset = rng.uniform(-20, 20) * strength
    curves = 255 * (levels[:, None] / 255) ** gamma * gains + offset
    return cv2.LUT(bgr, np.clip(curves, 0, 255).astype(np.uint8)[:, None])


def smeared(rng: np.random.Generator, image: np.ndarray) -> np.ndarray:
    """An image that is out of focus, or moved while it was taken, or neither."""
    kind = rng.random()
    if kind < 0.35:
        return cv2.GaussianBlur(image, (0, 0), rng.uniform(0.3, 1.4))
    if kind < 0.5:
        length = int(rng.integers(2, 6))
        kernel = np.zeros((7, 7), np.float32)
        angle = rng.uniform(0, np.pi)
        x, y = 3 * np.cos(angle) * length / 6, 3 * np.sin(angle) * length / 6
        ends = [(round(3 - x), round(3 - y)), (round(3 + x), round(3 + y))]
        cv2.line(kernel, ends[0], ends[1], 1.0)
        return cv2.filter2D(image, -1, kernel / kernel.sum())
    return image


def noisy(rng: np.random.Generator, image: np.ndarray) -> np.ndarray:
    """An image with the noise of a sensor."""
    if rng.random() < 0.3:
        return image
    noise = rng.standard_normal(image.shape, np.float32) * rng.uniform(0.5, 9)
    return cv2.add(image, noise, dtype=cv2.CV_8U)


def as_a_camera_sees(rng: np.random.Generator, image: np.ndarray) -> np.ndarray:
    """An image with other colors, blur and noise, of the same size."""
    return noisy(rng, smeared(rng, recolored(rng, image)))
