#!/usr/bin/env python3
"""Throws damaged messages and files at what takes them, and reports what does not survive.

Each target is a process of its own with little memory. What counts: a crash, a hang (10 s of CPU
time, or a minute of none), memory that is asked for or kept, an error that is no refusal, and a
refusal that is no line of text. The input is written to a file, with which it is thrown again:

    test/fuzz/fuzz.py --target messages --input build/fuzz/messages-1-230
"""

import argparse
import os
import random
import select
import struct
import subprocess
import sys
import tempfile
import time
from typing import Iterator, List, Optional

import messages
import mutations
import roslib.packages
import targets

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
IN_CPP = (*messages.SEEDS, "theora")
ALL = sorted((*targets.TARGETS, *IN_CPP))

MAX_CPU = 10.0  # s of CPU time for an input
MAX_SILENCE = 60.0  # s without an answer
MAX_KEPT = 400 << 20  # bytes: a pool's, and what an allocator has not given back


def program() -> str:
    """What takes messages as C++ nodes do."""
    return roslib.packages.find_node("robot_vision", "test_fuzz_messages")[0]


class SurvivalError(Exception):
    """An input was not survived."""


class Worker:
    """The process of a target."""

    def __init__(self, target: str):
        if target in IN_CPP:
            command = [program(), target]
        else:
            command = [sys.executable, os.path.join(HERE, "worker.py"), target]
        # Where its temporary files are: being killed, it does not remove them itself.
        self._folder = tempfile.TemporaryDirectory()
        self._process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=dict(os.environ, TMPDIR=self._folder.name),
        )
        self._answer()
        self._present = self._memory()

    def take(self, data: bytes) -> str:
        """What the target says of the input.

        Raises:
            SurvivalError: it has not survived.
        """
        try:
            self._process.stdin.write(struct.pack("<I", len(data)) + data)
            self._process.stdin.flush()
        except BrokenPipeError:
            pass  # its end is told by its answer
        answer = self._answer()
        kept = self._memory() - self._present
        if answer.startswith("failed"):
            raise SurvivalError(answer)
        if kept > MAX_KEPT:
            raise SurvivalError(f"{kept >> 20} MB are kept")
        return answer

    def end(self) -> None:
        self._process.kill()
        self._process.communicate()
        self._folder.cleanup()

    def _answer(self) -> str:
        began, cpu = time.monotonic(), self._cpu()
        while not select.select([self._process.stdout], [], [], 0.5)[0]:
            if self._cpu() - cpu > MAX_CPU or time.monotonic() - began > MAX_SILENCE:
                raise SurvivalError("it hangs")
        line = self._process.stdout.readline()
        if not line:
            raise SurvivalError(f"it has ended with code {self._process.wait()}")
        return line.decode().rstrip("\n")

    def _cpu(self) -> float:
        with open(f"/proc/{self._process.pid}/stat") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def _memory(self) -> int:
        try:
            with open(f"/proc/{self._process.pid}/statm") as file:
                return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
        except (IndexError, ValueError):
            return 0  # it has ended, which its answer tells


def seeds_of(target: str) -> List[bytes]:
    if target == "theora":
        return [subprocess.run([program(), "theora", "seed"], stdout=subprocess.PIPE).stdout]
    if target in messages.SEEDS:
        return messages.SEEDS[target]()
    return targets.TARGETS[target]().seeds()


def inputs_of(target: str, seed: int) -> Iterator[bytes]:
    """The good ones, and then damaged ones without end; the same for the same seed."""
    seeds = seeds_of(target)
    yield from seeds
    rng = random.Random(f"{target} {seed}")
    while True:
        yield mutations.mutated(rng, seeds)


def fuzz(target: str, seed: int, count: Optional[int], deadline: float, folder: str) -> List[str]:
    """Throws `count` inputs, or as many as there is time for. Returns what was not survived."""
    failures: List[str] = []
    worker, refused, number = Worker(target), 0, 0
    good = len(seeds_of(target))
    for number, data in enumerate(inputs_of(target, seed)):
        if number == count or time.monotonic() > deadline:
            break
        try:
            answer = worker.take(data)
            refused += answer != "taken"
            if number < good and answer != "taken":
                raise SurvivalError(f"a good one is {answer}")
        except SurvivalError as failure:
            os.makedirs(folder, exist_ok=True)
            path = os.path.join(folder, f"{target}-{seed}-{number}")
            with open(path, "wb") as file:
                file.write(data)
            failures.append(f"{target}: {failure}\n  input: {path}, {len(data)} bytes")
            worker.end()
            worker = Worker(target)
    worker.end()
    print(f"{target}: seed {seed}, {number} inputs, {refused} refused, {len(failures)} failures")
    return failures


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--target", action="append", choices=ALL, help="default: all")
    parser.add_argument("--minutes", type=float, default=10.0, help="in all (default: %(default)s)")
    parser.add_argument("--count", type=int, help="inputs for each target, whatever the time")
    parser.add_argument("--seed", type=int, default=int(time.time()), help="default: the time")
    parser.add_argument("--input", help="a file to throw at the target, once")
    parser.add_argument("--folder", default=os.path.join(ROOT, "build", "fuzz"))
    arguments = parser.parse_args()
    chosen = arguments.target or ALL
    if arguments.input:
        with open(arguments.input, "rb") as file:
            print(Worker(chosen[0]).take(file.read()))
        return 0
    failures: List[str] = []
    for target in chosen:
        limit = float("inf") if arguments.count else 60.0 * arguments.minutes / len(chosen)
        failures += fuzz(
            target, arguments.seed, arguments.count, time.monotonic() + limit, arguments.folder
        )
    print("\n".join(failures))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
