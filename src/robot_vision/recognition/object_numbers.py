"""The numbers of things of a kind, which each of them keeps from image to image."""

import itertools
from typing import Dict, List, NamedTuple, Sequence

import numpy as np

from ..depth.places import label_in_frames
from .found import Found

KEPT = 10  # images for which the number of what is not seen is not given to something new


class _Numbered(NamedTuple):
    place: np.ndarray  # (3,), m, of the middle of the box around it
    unseen: int  # images since it was seen


class ObjectNumbers:
    """Numbers what was found: coke 0, coke 1, ...

    Of two of a kind the more probable one is another one from image to image, as noise has it. What
    is nearest to where a number was, within half its diameter, has that number again. What is left
    over has the numbers that are: places are those in the camera's frame, which may move by more.
    """

    def __init__(self) -> None:
        self._known: Dict[str, Dict[int, _Numbered]] = {}  # by label and number

    def clear(self) -> None:
        """Forgets all that was seen."""
        self._known.clear()

    def of(self, found: Sequence[Found]) -> List[int]:
        """Returns the number of each object among those with its label, in the next image."""
        by_label: Dict[str, List[int]] = {}
        for index, one in enumerate(found):
            by_label.setdefault(label_in_frames(one.object.name), []).append(index)
        self._age()
        numbers = [0] * len(found)
        for label, indices in by_label.items():
            known = self._known.setdefault(label, {})
            for index, number in zip(indices, _numbered([found[i] for i in indices], known)):
                numbers[index] = number
                known[number] = _Numbered(found[index].middle, 0)
        return numbers

    def _age(self) -> None:
        """Counts an image, and forgets what has not been seen for too many of them."""
        for label, known in list(self._known.items()):
            self._known[label] = {
                number: _Numbered(one.place, one.unseen + 1)
                for number, one in known.items()
                if one.unseen < KEPT
            }
            if not self._known[label]:
                del self._known[label]


def _numbered(things: Sequence[Found], known: Dict[int, _Numbered]) -> List[int]:
    """Returns the numbers of things with one label.

    Those that are known go to the nearest, then what was seen lately to what is left over.
    """
    pairs = []
    for index, one in enumerate(things):
        reach = 0.5 * np.linalg.norm(np.ptp(one.object.corners, axis=0))
        for number, before in known.items():
            distance = np.linalg.norm(one.middle - before.place)
            is_far = distance > reach
            pairs.append((is_far, before.unseen if is_far else 0, distance, index, number))
    numbers: Dict[int, int] = {}
    for *_, index, number in sorted(pairs):
        if index not in numbers and number not in numbers.values():
            numbers[index] = number
    free = (number for number in itertools.count() if number not in known)
    return [numbers[index] if index in numbers else next(free) for index in range(len(things))]
