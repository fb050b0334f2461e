"""Who everybody is whose face is followed from frame to frame, by votes: one wrong look is none."""

import collections
import math
import statistics
from dataclasses import dataclass
from typing import Deque, Dict, Iterable, Tuple

UNKNOWN = "unknown"
MEMORY = 5.0  # s, for which a face that is not seen keeps its name


@dataclass
class VoteParams:
    max_distance: float = 80.0  # of the recogniser, above which a face is nobody's
    votes: int = 5  # predictions of which more than half give a name
    rate: float = 5.0  # Hz, predictions for one face


@dataclass(frozen=True)
class Identity:
    name: str  # UNKNOWN if it is nobody's
    distance: float  # of the recogniser; infinite if it knows nobody
    score: float  # 0 to 1: share of the votes that say so

    @property
    def known(self) -> bool:
        return self.name != UNKNOWN


@dataclass
class _Face:
    votes: Deque[Tuple[str, float]]  # the names of who looked most like it, and how far they were
    name: str
    predicted: float  # s, the last time
    seen: float  # s, the last time


class Identities:
    """The names of faces by the ids of their detector.

    A face gets a name when more than half of its last predictions agree, and loses it, to another
    or to none, when more than three quarters do: what alternates keeps its name. A time is in s on
    any clock that never goes back.
    """

    def __init__(self) -> None:
        self.params = VoteParams()  # may be replaced at any time
        self._faces: Dict[int, _Face] = {}

    def see(self, ids: Iterable[int], now: float) -> None:
        """These faces are seen now; those not seen for MEMORY are forgotten."""
        for number in ids:
            if number in self._faces:
                self._faces[number].seen = now
        self._faces = {n: f for n, f in self._faces.items() if now - f.seen <= MEMORY}

    def due(self, number: int, now: float) -> bool:
        """Whether a face is to be predicted anew."""
        face = self._faces.get(number)
        return face is None or now - face.predicted >= 1.0 / self.params.rate

    def vote(self, number: int, name: str, distance: float, now: float) -> None:
        """A prediction: who looks most like this face."""
        face = self._faces.get(number)
        if face is None or face.votes.maxlen != self.params.votes:
            votes = collections.deque(face.votes if face else (), self.params.votes)
            face = _Face(votes, face.name if face else UNKNOWN, now, now)
            self._faces[number] = face
        face.votes.append((name, distance))
        face.predicted = face.seen = now

    def of(self, number: int) -> Identity:
        """Who a face is."""
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
        """Who a face is that is not followed: its one prediction decides."""
        return Identity(self._accepted(name, distance), distance, 1.0)

    def clear(self) -> None:
        """Forgets everybody: other names are known now."""
        self._faces.clear()

    def _accepted(self, name: str, distance: float) -> str:
        return name if name and distance <= self.params.max_distance else UNKNOWN
