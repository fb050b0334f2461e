"""Trains the network of config/networks, which finds the things of the synthetic scenes.

tools/train_detector runs it. What was interrupted goes on where it was. The same seed and number of
steps give the same file, to the bit, with the same releases of PyTorch, OpenCV and NumPy on a
processor of the same kind: one thread computes, by deterministic algorithms, and each sample
follows from the seed and its number. Others give a file that finds as much, but is another one.
"""

import argparse
import hashlib
import pathlib
import sys
import time

import cv2
import numpy as np
import torch

from .dataset import Album
from .evaluation import examples_of, held_out_frames, precisions
from .export import facts, save
from .frames import room_album
from .tables import table_album
from .things import NAMES
from .training import Plan, Training

ROOT = pathlib.Path(__file__).resolve().parents[2]
NAME = "scene.onnx"
ROOMS, TABLES = 24, 40
ROOM_FRAMES, TABLE_FRAMES = 20, 12  # of each
EXAM = 77  # seed of the frames that the precision is measured with


def arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--steps", type=int, default=2500)
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "config" / "networks")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / ".ws" / "detector")
    return parser.parse_args()


def trained(plan: Plan, work: pathlib.Path) -> Training:
    """The training of a plan, from where it was interrupted to its end."""
    work.mkdir(parents=True, exist_ok=True)
    training = Training(plan, work / "checkpoint.pt")
    begin, losses = time.monotonic(), []
    if training.step:
        print(f"goes on from step {training.step} of {plan.steps}, as {work} has it", flush=True)

    def after(step: int, loss: float) -> None:
        losses.append(loss)
        if step % 50 == 0 or step == plan.steps:
            training.save()
            seconds = time.monotonic() - begin
            print(
                f"step {step} of {plan.steps}: loss {np.mean(losses):.3f}, {seconds:.0f} s",
                flush=True,
            )
            losses.clear()

    rooms = room_album(plan.seed, ROOMS, ROOM_FRAMES, held_out=False)
    tables = table_album(plan.seed, TABLES, TABLE_FRAMES, held_out=False)
    training.run(Album(rooms, tables), after)
    return training


def main() -> None:
    args = arguments()
    torch.set_num_threads(1)
    torch.use_deterministic_algorithms(True)
    cv2.setNumThreads(1)
    training = trained(Plan(args.seed, args.steps), args.work)

    path, metadata = args.output / NAME, facts(args.seed)
    args.output.mkdir(parents=True, exist_ok=True)
    save(training.mean, path, metadata)
    examples = examples_of(held_out_frames(EXAM), EXAM)
    found = precisions(cv2.dnn.readNetFromONNX(str(path)), examples)
    metadata["ap50"] = f"{np.mean(found):.4f}"
    metadata["ap50_of_classes"] = str({n: round(ap, 4) for n, ap in zip(NAMES, found)})
    save(training.mean, path, metadata)
    for name, ap in zip(NAMES, found):
        print(f"AP50 of {name}: {ap:.4f}")
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    (args.output / "SHA256SUMS").write_text(f"{digest}  {NAME}\n")
    training.finish()
    print(f"{path}: {path.stat().st_size} bytes, mean AP50 {np.mean(found):.4f}, SHA-256 {digest}")


if __name__ == "__main__":
    sys.exit(main())
