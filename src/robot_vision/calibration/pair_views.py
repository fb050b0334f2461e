"""Chooses the pairs of images of a board that tell something new about two cameras."""

from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .boards import Board, Observation
from .same_points import SamePoints
from .views import ViewCollection

MIN_PAIRS = 5


class PairView(NamedTuple):
    """A pair that is used: its name, and the same points of the board in both images."""

    name: str
    left: Observation
    right: Observation


class PairCollection:
    """Keeps pairs of which at least one image shows the board as none before it did.

    What only one camera sees is kept too, because it tells something about that camera.

    Args:
        board: The board to look for.
        turns: By how many quarter turns it looks the same, as of board_pose.quarter_turns().
        most: The largest number of pairs that are kept.
        max_blur: The largest width in px of an edge in an image that counts as sharp.
    """

    def __init__(self, board: Board, turns: Sequence[int], most: int, max_blur: float):
        self._same_points = SamePoints(board, turns)
        self._most = most
        self._cameras = ViewCollection(board, most, max_blur), ViewCollection(board, most, max_blur)
        self.pairs: List[PairView] = []
        self.offered = self.unusable = self.in_none = self.alike = 0
        self.in_one = [0, 0]  # pairs with the board in the left image only, and in the right one

    @property
    def size(self) -> Optional[Tuple[int, int]]:
        """The width and height of the images in px; None until one shows the board."""
        return self._cameras[0].size or self._cameras[1].size

    @property
    def full(self) -> bool:
        """Whether no more pairs are kept: there are enough of them, or of both cameras' views."""
        return len(self.pairs) == self._most or all(camera.full for camera in self._cameras)

    def offer(self, name: str, images: Tuple[np.ndarray, np.ndarray]) -> None:
        """Examines the left and the right image, (height, width) uint8, and keeps what is of use.

        Raises:
            ValueError: The two differ in size, or from those before.
        """
        left, right = (f"{image.shape[1]}x{image.shape[0]}" for image in images)
        if left != right:
            raise ValueError(f"the left image has {left}, the right one {right}, must be equal")
        kept = self._kept()
        seen = [camera.offer(name, image) for camera, image in zip(self._cameras, images)]
        for camera in self._cameras:
            camera.size = self.size
        self.offered += 1
        both = self._same_points.of(*seen) if None not in seen else None
        if both and self._kept() > kept and len(self.pairs) < self._most:
            self.pairs.append(PairView(name, *both))
        elif both:
            self.alike += 1
        elif seen[0] and not seen[1]:
            self.in_one[0] += 1
        elif seen[1] and not seen[0]:
            self.in_one[1] += 1
        else:  # or both images show parts of the board that have too little in common
            self.in_none += 1

    def skip(self) -> None:
        """Counts a pair that cannot be examined."""
        self.offered += 1
        self.unusable += 1

    def summary(self) -> str:
        """Returns how many pairs were used, and why others were not, as a line of text."""
        left, right = self.in_one
        unusable = f", {self.unusable} unusable" if self.unusable else ""
        return (
            f"{self.offered} pairs: {len(self.pairs)} used, {left} with a sharp board in the left "
            f"image only, {right} in the right one only, {self.in_none} in none, {self.alike} "
            f"like others{unusable}"
        )

    def of_camera(self, side: int) -> List[Observation]:
        """Returns all that tells something about the left camera, 0, or the right one, 1."""
        in_pairs = {pair.name for pair in self.pairs}
        alone = [one for one in self._cameras[side].views if one.name not in in_pairs]
        return [pair[1 + side] for pair in self.pairs] + [one.observation for one in alone]

    def require_enough(self) -> None:
        """Raises ValueError unless there are as many pairs as a calibration needs at least."""
        if len(self.pairs) >= MIN_PAIRS:
            return
        left, right = self.in_one
        raise ValueError(
            f"{len(self.pairs)} pairs show the board well in both images, {MIN_PAIRS} are needed "
            f"at least; {left} show it in the left one only, {right} in the right one only"
        )

    def _kept(self) -> int:
        return sum(len(camera.views) for camera in self._cameras)
