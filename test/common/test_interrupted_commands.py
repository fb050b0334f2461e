"""Commands that Ctrl-C interrupts leave no incomplete files, and print no traceback."""

import contextlib
import os
import pathlib
import signal
import subprocess
import time

import cv2
import numpy as np
import pytest
import roslib.packages
import yaml
from board_views import SQUARE, PairStudio, Studio, chessboard
from interruptions import ALL, interrupted_at, moments
from tags import CAMERAS, SIZE, corners_of, matrix, pose_in_view, turned

import robot_vision as rv
from robot_vision.calibration import calibrate_headless
from robot_vision.color import pick_color
from robot_vision.common.commands import INTERRUPTED
from robot_vision.markers import create_marker
from robot_vision.tags import calibrate_bundle

OLD = b"old: 1\n"


def create_a_marker(folder, _):
    return create_marker.main, ["--output", folder / "made" / "a.png", "1"], ["a.png"]


def pick_a_color(folder, _):
    words = ["--hex", "#1e90ff", "--save", folder / "made" / "a.yaml", "--name", "a"]
    return pick_color.main, words, ["a.yaml"]


def learn_a_bundle(folder, monkeypatch):
    """The frames are there already, because Ctrl-C while they arrive would begin the work."""
    rng = np.random.default_rng(1)
    places = {tag: matrix(turned([0.3 * tag, 0, 0]), [0.3 * tag, 0, 0]) for tag in range(3)}
    bodies = [pose_in_view(rng, 60, rng.uniform(0, 0.7)) for _ in range(8)]
    camera = CAMERAS["plumb_bob"]

    def collect(_arguments, collection, _progress):
        for body in bodies:
            seen = [(tag, corners_of(body @ place, camera)) for tag, place in places.items()]
            collection.add(camera, seen)
        return camera

    monkeypatch.setattr(calibrate_bundle, "_collect", collect)
    words = ["--name", "a", "--ids", "0-2", "--size", SIZE, "--output", folder / "made" / "a.yaml"]
    return calibrate_bundle.main, [*words, "--force"], ["a.yaml"]


def calibrate_a_camera(folder, _):
    lens = rv.CameraModel(320, 240, [260.0, 0, 160, 0, 262, 118, 0, 0, 1], [-0.2, 0.05, 0, 0])
    board = Studio(chessboard(6, 5), lens)
    images = folder / "images"
    images.mkdir()
    for number in range(6):
        cv2.imwrite(str(images / f"{number}.png"), board.frame())
    words = ["--size", "6x5", "--square", SQUARE, "--output", folder / "made" / "a.yaml", images]
    return calibrate_headless.main, words, ["a.yaml", "a.png"]


def calibrate_a_pair(folder, _):
    left, right = (
        rv.CameraModel(320, 240, [260.0, 0, 160, 0, 262, 118, 0, 0, 1], [k1, 0.05, 0, 0])
        for k1 in (-0.2, -0.15)
    )
    to_right = np.eye(4)
    to_right[0, 3] = -0.05
    board = PairStudio(chessboard(6, 5), left, right, to_right)
    folders = [folder / side for side in ("left", "right")]
    for made in folders:
        made.mkdir()
    for number in range(6):
        for made, image in zip(folders, board.pair()):
            cv2.imwrite(str(made / f"{number}.png"), image)
    words = ["--stereo", "--size", "6x5", "--square", SQUARE, *folders]
    output = ["--output", folder / "made" / "a.yaml"]
    return calibrate_headless.main, [*words, *output], ["a_left.yaml", "a_right.yaml", "a.png"]


def shape(path):
    """What is the same in all complete files: the end of a PNG, or the keys of a YAML file."""
    data = path.read_bytes()
    return data[-12:] if path.suffix == ".png" else ([*yaml.safe_load(data)], data[-1:])


COMMANDS = [create_a_marker, pick_a_color, learn_a_bundle, calibrate_a_camera, calibrate_a_pair]


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.__name__)
def test_interrupted_at_any_call(tmp_path, monkeypatch, command):
    """Old files are unchanged, or new ones are complete; there are no other files."""
    (tmp_path / "made").mkdir()
    main, words, names = command(tmp_path, monkeypatch)
    words, paths = list(map(str, words)), {tmp_path / "made" / name for name in names}
    if "--force" in words:
        for path in paths:
            path.write_bytes(OLD)
    code, output = interrupted_at(main, words, ALL)
    assert code == 0, output
    whole = {path: shape(path) for path in paths}
    codes = []
    for call in moments(int(output.split()[-1])):
        for path in paths:
            if "--force" in words:
                path.write_bytes(OLD)
            elif path.exists():
                path.unlink()
        code, output = interrupted_at(main, words, call)
        codes.append(code)
        # While calibrate_headless.py reads images, Ctrl-C means that there are enough.
        too_few = code == 1 and "\ncalibrate_headless.py: " in "\n" + output
        assert (code in (0, INTERRUPTED) or too_few) and "Traceback" not in output, (call, output)
        assert set((tmp_path / "made").iterdir()) <= paths
        for path in filter(os.path.exists, paths):
            old = "--force" in words and code and path.read_bytes() == OLD
            assert old or shape(path) == whole[path], (call, output)
    assert codes.count(INTERRUPTED) > 10 and codes[-1] == 0


def interrupted_by_itself(words, is_stuck, **options):
    """Asserts that the signal ends a program that is stuck, and that it prints nothing."""
    own = {"stderr": subprocess.PIPE, "start_new_session": True, "text": True, **options}
    with subprocess.Popen(list(map(str, words)), **own) as process:
        deadline = time.monotonic() + 60.0
        try:
            while not is_stuck(process.pid):
                assert time.monotonic() < deadline, "it is not stuck"
                time.sleep(0.01)
        finally:
            os.killpg(process.pid, signal.SIGINT)
        _, said = process.communicate(timeout=60.0)
    assert process.returncode == -signal.SIGINT  # shells show 130
    assert said == ""


def test_list_cameras_interrupted_while_nobody_reads_its_output():
    program = roslib.packages.find_node("robot_vision", "list_cameras")[0]
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writer, bytes(4096))
    os.set_blocking(writer, True)

    def sleeps(process):
        name, state = pathlib.Path(f"/proc/{process}/stat").read_text().split()[1:3]
        return (name, state) == ("(list_cameras)", "S")

    interrupted_by_itself([program, "--help"], sleeps, stdout=writer)
    os.close(reader)
    os.close(writer)


def test_check_arguments_interrupted_while_it_reads(tmp_path):
    """A shell plays roslaunch, the parent process, whose command names the launch file."""
    program = roslib.packages.find_node("robot_vision", "check_arguments.py")[0]
    pipe = tmp_path / "our.launch"
    os.mkfifo(str(pipe))
    writers = []

    def reads(_):
        with contextlib.suppress(OSError):  # the program has not opened the pipe yet
            writers.append(os.open(str(pipe), os.O_WRONLY | os.O_NONBLOCK))
        return writers

    command = ["sh", "-c", '"$0" "$1"; exit', program, pipe]
    interrupted_by_itself(command, reads)
    os.close(writers[0])
