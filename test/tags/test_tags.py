"""Photographs and noise must not be taken for AprilTags."""

import cv2
import numpy as np
import skimage.data

import robot_vision as rv

CROP = (128, 96)  # px


def photographs():
    """Gray photographs of people, things, textures, prints and the sky."""
    names = ("astronaut", "brick", "camera", "cat", "coffee", "coins", "grass", "gravel")
    names += ("hubble_deep_field", "page", "retina", "rocket", "text")
    for name in names:
        image = getattr(skimage.data, name)()
        yield cv2.cvtColor(image, cv2.COLOR_RGB2GRAY) if image.ndim == 3 else image


def crops(count):
    """Parts of the photographs in many scales; each tenth is random noise instead."""
    random = np.random.default_rng(1)
    images = list(photographs())
    for number in range(count):
        if number % 10 == 9:
            noise = random.integers(0, 256, CROP[::-1], np.uint8)
            if number % 20 == 19:
                noise = cv2.GaussianBlur(noise, (0, 0), random.uniform(0.7, 3.0))
                noise = cv2.normalize(noise, None, 0, 255, cv2.NORM_MINMAX)
            yield noise
            continue
        image = images[random.integers(len(images))]
        scale = np.exp(random.uniform(-1.2, 1.0))
        width, height = (
            min(int(side / scale), limit) for side, limit in zip(CROP, image.shape[::-1])
        )
        x = random.integers(image.shape[1] - width + 1)
        y = random.integers(image.shape[0] - height + 1)
        part = image[y : y + height, x : x + width]
        way = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_CUBIC
        yield cv2.resize(part, CROP, interpolation=way)


def test_no_tags_are_found_in_photographs_and_noise():
    """The similarity, and not the margin, tells false detections from tags."""
    params = rv.TagDetectorParams()
    params.families = [family.name for family in rv.tag_families()]
    usual = rv.TagDetector(params)
    params.min_similarity = -1.0
    believing = rv.TagDetector(params)
    ghosts = []
    for number, image in enumerate(crops(5000)):
        found = believing.detect(image, "mono8")
        assert not found or not usual.detect(image, "mono8"), number
        ghosts += found
    assert len(ghosts) > 20
    assert max(ghost.margin for ghost in ghosts) > 40.0
    assert max(ghost.similarity for ghost in ghosts) < rv.TagDetectorParams().min_similarity
