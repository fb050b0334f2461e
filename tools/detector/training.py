"""The training itself: steps, learning rate, the mean of the weights, and where it was stopped."""

import math
import pathlib
from typing import Callable, Dict, NamedTuple

import torch
from torch.utils.data import DataLoader

from .dataset import Album, Samples
from .losses import loss_of
from .network import SceneNetwork

BATCH = 16
PEAK_RATE = 3e-3  # of learning
LONGER = 1.44  # the cosine is that of a training with so many times as many steps
WARM_UP = 0.05  # share of these in which the rate rises
FALL = 1.67  # how steep the line is in which the rate falls to the end, by its peak
DECAY = 0.02  # of the weights
KEPT = 0.998  # share of the mean of the weights that a step keeps
MAX_GRADIENT = 10.0


class Plan(NamedTuple):
    """What decides the result."""

    seed: int
    steps: int


def rate_at(step: int, steps: int) -> float:
    """The learning rate: it rises in a line, falls as a cosine, and at last in a line."""
    done = (step + 1) / (LONGER * steps)
    if done < WARM_UP:
        return PEAK_RATE * done / WARM_UP
    cosine = 0.01 + 0.99 * (1 + math.cos(math.pi * (done - WARM_UP) / (1 - WARM_UP))) / 2
    line = 0.01 + FALL * (1 - (step + 1) / steps)
    return PEAK_RATE * min(cosine, line)


def follow(mean: SceneNetwork, network: SceneNetwork, step: int) -> None:
    """Moves the mean of the weights towards the weights; less and less in the first steps."""
    kept = min(KEPT, (step + 1) / (step + 10))
    with torch.no_grad():
        for average, value in zip(mean.state_dict().values(), network.state_dict().values()):
            if value.dtype.is_floating_point:
                average.mul_(kept).add_(value, alpha=1 - kept)
            else:
                average.copy_(value)


class Training:
    """Trains a network, and goes on where it was stopped."""

    def __init__(self, plan: Plan, checkpoint: pathlib.Path):
        torch.manual_seed(plan.seed)
        self.plan, self.step, self._checkpoint = plan, 0, checkpoint
        self.network, self.mean = SceneNetwork(), SceneNetwork()
        self.mean.load_state_dict(self.network.state_dict())
        self._optimizer = torch.optim.AdamW(
            self.network.parameters(), PEAK_RATE, weight_decay=DECAY
        )
        if checkpoint.exists():
            self._load(torch.load(checkpoint))

    def _parts(self) -> Dict[str, object]:
        return {"network": self.network, "mean": self.mean, "optimizer": self._optimizer}

    def _load(self, state: Dict[str, object]) -> None:
        if state["plan"] == tuple(self.plan):
            self.step = state["step"]
            for name, part in self._parts().items():
                part.load_state_dict(state[name])

    def save(self) -> None:
        """Writes all that is needed to go on, in one step."""
        state = {name: part.state_dict() for name, part in self._parts().items()}
        fresh = self._checkpoint.with_suffix(".new")
        torch.save({"plan": tuple(self.plan), "step": self.step, **state}, fresh)
        fresh.replace(self._checkpoint)

    def finish(self) -> None:
        """Forgets where it was: a checkpoint does not know what has changed in the code since."""
        self._checkpoint.unlink(missing_ok=True)

    def run(self, album: Album, after: Callable[[int, float], None]) -> None:
        """Trains until all steps are done; calls after(step, loss) after each."""
        first, last = self.step * BATCH, self.plan.steps * BATCH
        samples = Samples(album, self.plan.seed, first, last)
        self.network.train()
        for batch in DataLoader(samples, BATCH, num_workers=1, prefetch_factor=4):
            loss = self._learn(batch)
            self.step += 1
            after(self.step, loss)

    def _learn(self, batch: Dict[str, torch.Tensor]) -> float:
        for group in self._optimizer.param_groups:
            group["lr"] = rate_at(self.step, self.plan.steps)
        boxes, scores = self.network(batch["images"].float() / 255)
        loss = loss_of(boxes, scores, batch["classes"], batch["boxes"], batch["unclear"])
        self._optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.network.parameters(), MAX_GRADIENT)
        self._optimizer.step()
        follow(self.mean, self.network, self.step)
        return float(loss)
