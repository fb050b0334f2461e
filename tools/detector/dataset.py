"""The training's samples, made while it goes on: each follows from the seed and its number."""

from typing import Dict, List, NamedTuple

import cv2
import numpy as np
import torch
from torch.utils.data import Dataset

from .frames import Frame
from .targets import targets_of
from .views import Sample, collage, cutouts_of, part_of

COLLAGES, TABLES = 0.3, 0.45  # shares of the samples; the others are frames of rooms


class Album(NamedTuple):
    """The frames that samples are made of."""

    rooms: List[Frame]
    tables: List[Frame]


def tensors(sample: Sample) -> Dict[str, torch.Tensor]:
    """A sample as the network's input and what is asked of its output."""
    targets = targets_of(sample.labels)
    rgb = np.ascontiguousarray(sample.image[..., ::-1].transpose(2, 0, 1))
    return {
        "images": torch.from_numpy(rgb),
        "classes": torch.from_numpy(targets.classes),
        "boxes": torch.from_numpy(targets.boxes),
        "unclear": torch.from_numpy(targets.unclear),
    }


class Samples(Dataset):
    """The samples from number `begin` to before `end`."""

    def __init__(self, album: Album, seed: int, begin: int, end: int):
        self._album = album
        self._cutouts = cutouts_of([*album.rooms, *album.tables])
        self._seed, self._begin, self._end = seed, begin, end
        cv2.setNumThreads(1)

    def __len__(self) -> int:
        return self._end - self._begin

    def __getitem__(self, number: int) -> Dict[str, torch.Tensor]:
        rng = np.random.default_rng([self._seed, self._begin + number])
        kind = rng.random()
        if kind < COLLAGES:
            return tensors(collage(rng, self._cutouts))
        frames = self._album.tables if kind < COLLAGES + TABLES else self._album.rooms
        return tensors(part_of(rng, frames[int(rng.integers(len(frames)))]))
