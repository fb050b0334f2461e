"""Decides by votes who the tracked faces are, so that a single wrong prediction does not count."""

import collections
import math
import statistics
from dataclasses import dataclass
from typing import Deque, Dict, Iterable, Tuple

UNKNOWN = "unknown"
MEMORY = 5.0  # s that a face keeps its name without being seen


@dataclass
class VoteParams:
    max_distance: float = 80.0  # of the recogniser; beyond it a face is unknown
    votes: int = 5  # last predictions, of which more than half have to agree on a name
    rate: float = 5.0  # Hz, predictions for one face


@dataclass(frozen=True)
class Identity:
    name: str  # or UNKNOWN
    distance: float  # of the recogniser; infinite if it knows nobody
    score: float  # 0 to 1, share of the votes for this name

    @property
    def known(self) -> bool:
        return self.name != UNKNOWN


@dataclass
class _Face:
    votes: Deque[Tuple[str, float]]  # name and distance of the most similar person
    name: str
    predicted: float  # s, time of the last prediction
    seen: float  # s, when it was seen last


class Identities:
    """The names of faces by the ids of their detector.

    A face gets a name when more than half of its last predictions agree on it. It gets another
    name, or none, when more than three quarters agree on that, so that it keeps its name if
    predictions alternate. All times are in s of any clock that never goes back.
    """

    def __init__(self) -> None:
        self.params = VoteParams()  # may be replaced at any time
        self._faces: Dict[int, _Face] = {}

    def see(self, ids: Iterable[int], now: float) -> None:
        """Forgets faces that were not seen for MEMORY, and notes that these are seen.

        It has to be called before the votes of the same image, because a face that comes back
        after MEMORY may be another person's.
        """
        self._faces = {n: f for n, f in self._faces.items() if now - f.seen <= MEMORY}
        for number in ids:
            if number in self._faces:
                self._faces[number].seen = now

    def due(self, number: int, now: float) -> bool:
        """Returns whether a face has to be predicted again."""
        face = self._faces.get(number)
        return face is None or now - face.predicted >= 1.0 / self.params.rate

    def vote(self, number: int, name: str, distance: float, now: float) -> None:
        """Adds a prediction: the person who is most similar to this face, and the distance."""
        face = self._faces.get(number)
        if face is None or face.votes.maxlen != self.params.votes:
            votes = collections.deque(face.votes if face else (), self.params.votes)
            face = _Face(votes, face.name if face else UNKNOWN, now, now)
            self._faces[number] = face
        face.votes.append((name, distance))
        face.predicted = face.seen = now

    def of(self, number: int) -> Identity:
        """Returns the identity of a face."""
        face = self._faces.get(number)
        if face is None:
            return Identity(UNKNOWN, math.inf, 0.0)
        named = [(self._accepted(name, distance), distance) for name, distance in face.votes]
        counts = collections.Counter(name for name, _ in named)
        name, count = counts.most_common(1)[0]
        if count > (0.75 if face.name != UNKNOWN else 0.5) * self.params.votes:
            face.name = name
        agreeing = [distance for name, distance in named if name == face.name]
        distances = agreeing or [distance for _, distance in named]
        score = len(agreeing) / self.params.votes
        return Identity(face.name, statistics.median(distances), min(score, 1.0))

    def at_once(self, name: str, distance: float) -> Identity:
        """Returns the identity of a face without an id, by its single prediction."""
        return Identity(self._accepted(name, distance), distance, 1.0)

    def clear(self) -> None:
        """Forgets all faces, because other people are known now."""
        self._faces.clear()

    def _accepted(self, name: str, distance: float) -> str:
        return name if name and distance <= self.params.max_distance else UNKNOWN
