"""From which score on the things of each class are reported."""

from typing import Sequence, Tuple

from ..common.plain_text import brief
from ..common.ranges import require_range
from ..common.yaml_text import load_yaml

SURE = 0.5  # what the tracker takes for the score from which a detection is sure


class ClassThresholds:
    """The lowest score of each class, and which classes are left out.

    Args:
        names: The names of the classes.
        general: The score of all classes that have none of their own.
        single: Scores of single classes, as the text of a flat YAML map without braces; what is no
            name may be a class's number.
        only: Names between commas of the classes that are reported; empty: all.

    Attributes:
        scores: One for each class.

    Raises:
        ValueError: A text cannot be read, names a class that is not there, or has a score that is
            no number from 0 to 1.
    """

    def __init__(self, names: Sequence[str], general: float, single: str = "", only: str = ""):
        self._names = names
        self._general = general
        self.scores = [general] * len(names)
        for key, score in self._map_of(single).items():
            if type(score) not in (int, float):
                raise ValueError(f"class_scores: {brief(key)} has {brief(score)}, not a number")
            require_range(f"class_scores: {brief(key)}", score, 0.0, 1.0)
            for number in self._numbers(key, "class_scores"):
                self.scores[number] = float(score)
        words = [word.strip() for word in only.split(",") if word.strip()]
        wanted = [number for word in words for number in self._numbers(word, "only")]
        self._wanted = set(wanted)  # none: all are

    def wants(self, class_id: int) -> bool:
        """Returns whether a class is reported."""
        return not self._wanted or class_id in self._wanted

    def is_sure(self, class_id: int, score: float) -> bool:
        """Returns whether a detection is reported."""
        return self.wants(class_id) and score >= self._threshold(class_id)

    def for_tracker(self, class_id: int, score: float) -> float:
        """Returns a score on a scale from 0 to 1 on which the threshold of each class is SURE.

        What networks give out may be more than 1.
        """
        threshold, score = self._threshold(class_id), min(score, 1.0)
        if score < threshold:
            return SURE * score / threshold
        return SURE + (1.0 - SURE) * (score - threshold) / max(1.0 - threshold, 1e-9)

    def from_tracker(self, class_id: int, score: float) -> float:
        """Returns the score that for_tracker() was given."""
        threshold = self._threshold(class_id)
        if score < SURE:
            return threshold * score / SURE
        return threshold + (1.0 - threshold) * (score - SURE) / (1.0 - SURE)

    def _threshold(self, class_id: int) -> float:
        """The score of a class, which a network may have without having announced it."""
        return self.scores[class_id] if class_id < len(self.scores) else self._general

    def _map_of(self, text: str) -> "dict[object, object]":
        if not text.strip():
            return {}
        try:
            values = load_yaml("{" + text + "}")
        except ValueError as error:
            raise ValueError(f"class_scores is {brief(text)}: {error}") from None
        if not isinstance(values, dict):
            raise ValueError(f"class_scores is {brief(text)}, must be such as person: 0.5")
        return values

    def _numbers(self, key: object, parameter: str) -> Tuple[int, ...]:
        found = tuple(number for number, name in enumerate(self._names) if name == str(key))
        if found:
            return found
        text = str(key)
        if text.isdecimal() and len(text) < 10 and int(text) < len(self._names):
            return (int(text),)
        known = ", ".join(self._names[:10]) + (", ..." if len(self._names) > 10 else "")
        raise ValueError(f"{parameter} names the class {brief(key)}, but there are {known}")
