"""Generated images: backgrounds of collages and posters for the room. Nothing is photographed."""

import cv2
import numpy as np


def random_color(rng: np.random.Generator) -> np.ndarray:
    """A BGR color, 0 to 255; grays and pale colors are as frequent as vivid ones."""
    gray = rng.uniform(10, 245)
    return np.clip(gray + rng.uniform(0, 1) * (rng.uniform(0, 255, 3) - gray), 0, 255)


def gradient(rng: np.random.Generator, width: int, height: int) -> np.ndarray:
    """One color that becomes another from one side to the other; float32."""
    angle = rng.uniform(0, 2 * np.pi)
    x = np.linspace(-0.5, 0.5, width) * np.cos(angle)
    y = np.linspace(-0.5, 0.5, height) * np.sin(angle)
    share = np.clip(0.5 + x + y[:, None], 0, 1)[..., None]
    mixed = random_color(rng) * share + random_color(rng) * (1 - share)
    return mixed.astype(np.float32)


def clouds(rng: np.random.Generator, width: int, height: int) -> np.ndarray:
    """Noise of several scales between colors; float32."""
    image = np.zeros((height, width, 3), np.float32)
    strength = rng.uniform(0.3, 1.0)
    for cells in (2, 5, 12, 30, 80):
        grid = rng.normal(0, 90 * strength, (cells, cells, 3)).astype(np.float32)
        if rng.random() < 0.7:
            grid[:] = grid[..., :1]
        image += cv2.resize(grid, (width, height), interpolation=cv2.INTER_CUBIC)
        strength *= rng.uniform(0.3, 0.9)
    return image + random_color(rng).astype(np.float32)


def stripes(rng: np.random.Generator, width: int, height: int) -> np.ndarray:
    """Stripes of two colors, as of boards or curtains; float32."""
    angle = rng.choice([0.0, np.pi / 2, rng.uniform(0, np.pi)])
    period = rng.uniform(6, 80)
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    phase = (x * np.cos(angle) + y * np.sin(angle)) / period + rng.uniform()
    edge = (np.mod(phase, 1) < rng.uniform(0.05, 0.6))[..., None]
    return np.where(edge, random_color(rng), random_color(rng)).astype(np.float32)


def add_shapes(rng: np.random.Generator, image: np.ndarray, count: int) -> None:
    """Draws polygons and ellipses of one color each into an image of 8 bits."""
    height, width = image.shape[:2]
    for _ in range(count):
        color = random_color(rng).tolist()
        middle = rng.uniform(0, 1, 2) * (width, height)
        size = rng.uniform(0.02, 0.35) * max(width, height)
        if rng.random() < 0.3:  # much longer than wide: what is round shall be a ball
            axes = (int(size) + 1, int(size * rng.uniform(0.1, 0.5)) + 1)
            center = (int(middle[0]), int(middle[1]))
            cv2.ellipse(image, center, axes, rng.uniform(0, 180), 0, 360, color, -1, cv2.LINE_AA)
        else:
            corners = middle + rng.uniform(-size, size, (int(rng.integers(3, 7)), 2))
            hull = cv2.convexHull(corners.astype(np.int32))
            cv2.fillConvexPoly(image, hull, color, cv2.LINE_AA)


def pattern(rng: np.random.Generator, width: int, height: int) -> np.ndarray:
    """An image of gradients, noise, stripes and shapes: (height, width, 3) uint8."""
    makers = (gradient, clouds, stripes)
    image = makers[rng.choice(3, p=(0.35, 0.45, 0.2))](rng, width, height)
    if rng.random() < 0.5:
        image = image * 0.6 + clouds(rng, width, height) * 0.4
    result = np.clip(image, 0, 255).astype(np.uint8)
    add_shapes(rng, result, int(rng.choice([0, 4, 12, 30])))
    return result


def poster(rng: np.random.Generator) -> np.ndarray:
    """An image for the room's wall, upright or lying."""
    width, height = rng.integers(160, 480, 2)
    return pattern(rng, int(width), int(height))
