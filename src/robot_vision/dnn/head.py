"""How the outputs of a network are read, and what is known of it when that is looked for."""

import dataclasses
from typing import List, Tuple

from .model_facts import ModelFile

UNCOUNTED = 1000  # classes, where neither the outputs nor the model say how many there are


@dataclasses.dataclass(frozen=True)
class Head:
    """How the outputs of a network are read."""

    head: str
    reason: str  # why it is taken for that, in words
    classes: int = UNCOUNTED
    counted: bool = True  # whether the number of classes is known
    task: str = "detect"
    keypoints: int = 0
    keypoint_values: int = 3
    strides: Tuple[int, ...] = ()  # px, of the cells; empty: those of the family
    order: Tuple[int, ...] = ()  # numbers of the outputs, as the decoder wants them
    trained_as: str = ""  # the head of the family whose images it wants; empty: its own


@dataclasses.dataclass(frozen=True)
class Seen:
    """What is known of a network when its head is looked for."""

    shapes: List[Tuple[int, ...]]
    names: List[str]
    model: ModelFile
    width: int
    height: int
    counts: Tuple[int, ...]  # of classes, as the model or the user says; of several one is right
    task: str  # as the model or the user says; empty: neither does
    forced: bool  # the user has named the head

    def cells(self, *strides: int, partial: bool = False) -> int:
        """How many cells of these sizes the input has; `partial`: also those that it cuts."""
        rest = [one - 1 if partial else 0 for one in strides]
        sides = [(self.width + more, self.height + more) for more in rest]
        return sum((w // one) * (h // one) for one, (w, h) in zip(strides, sides))

    @property
    def told_count(self) -> int:
        """How many classes there are where only the model or the user says so."""
        return next(iter(self.counts), UNCOUNTED)

    def mentions(self, word: str) -> bool:
        """Whether the model's own texts have a word."""
        texts = (self.model.producer, *self.model.metadata.values())
        return any(word in text[:1000].lower().replace("-", "") for text in texts)
