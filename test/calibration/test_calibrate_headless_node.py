"""The command calibrate_headless.py: from files, a video, a bag and a camera, and clear errors."""

import contextlib
import itertools
import os
import re

import cv2
import numpy as np
import pytest
import rosbag
import rosgraph
import rospy
import support
import yaml
from frames import message
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from sensor_msgs.srv import SetCameraInfo, SetCameraInfoResponse

from robot_vision import CalibrationScene, SceneParams
from robot_vision.calibration import calibrate_headless
from robot_vision.calibration.calibrate_headless import main
from robot_vision.calibration.solving import calibrate as solve

IMAGE = "/eye/image_raw"
BOARD = ["--size", "8x6", "--square", "0.05"]
COUNT = 10


@pytest.fixture(scope="module")
def images():
    params = SceneParams()
    params.rate = 2.0  # each frame another pose
    scene = CalibrationScene(params)
    return [scene.render(number) for number in range(COUNT)]


@pytest.fixture(scope="module")
def folder(images, tmp_path_factory):
    path = tmp_path_factory.mktemp("images")
    for number, image in enumerate(images):
        cv2.imwrite(str(path / f"{number:02}.png"), image)
    (path / "notes.txt").write_text("no image")
    return path


@pytest.fixture
def calibrate(run_main):
    """Runs the command here: its exit code and its output."""

    def run(*arguments, board=BOARD):
        return run_main(main, ["calibrate_headless.py", *board, *arguments])

    return run


def assert_found(path):
    found, truth = yaml.safe_load(path.read_text()), CalibrationScene().camera
    assert np.allclose(found["camera_matrix"]["data"], truth.K.ravel(), rtol=0.005)
    assert np.allclose(found["distortion_coefficients"]["data"], truth.D, atol=0.02)
    assert (found["image_width"], found["image_height"]) == (640, 480)


def refused(calibrate, *arguments, **options):
    """The error of a command that ends with 1."""
    code, output = calibrate(*arguments, **options)
    *_, error = output.splitlines()
    assert code == 1 and error.startswith("calibrate_headless.py: "), output
    return error


def test_from_a_folder_to_the_next_start_of_the_camera(
    calibrate, start, folder, monkeypatch, tmp_path
):
    """Into the file that the camera loads by its name."""
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    code, output = calibrate(folder, "--camera-name", "eye")
    assert code == 0, output
    lines = output.splitlines()
    assert f"{COUNT} images: {COUNT} used, 0 without the board, 0 blurred, 0 like others" in lines
    assert "plumb_bob, 640x480" in lines and "  k3 0" in lines
    assert any(re.fullmatch(r"  fx \d+\.?\d* \+- 0\.\d+ px", line) for line in lines)
    assert sum(line.startswith(f"  {folder}/0") and "px" in line for line in lines) == COUNT
    path = tmp_path / "camera_info" / "eye.yaml"
    assert f"saved in {path}" in lines
    assert_found(path)
    coverage = cv2.imread(str(path.with_suffix(".png")))
    assert coverage.shape == (480, 640, 3)

    start("camera_node", f"_source:={folder}", "_loop:=true", "_camera_name:=eye")
    info = support.Messages("/camera/camera_info", CameraInfo).wait()[0]
    saved = yaml.safe_load(path.read_text())
    assert np.allclose(info.K, saved["camera_matrix"]["data"], rtol=1e-6)
    assert np.allclose(info.D, saved["distortion_coefficients"]["data"], rtol=1e-6)
    assert np.allclose(info.P, saved["projection_matrix"]["data"], rtol=1e-6)

    error = refused(calibrate, folder, "--camera-name", "eye")
    assert error == f"calibrate_headless.py: {path} is there already; --force replaces it"
    path.unlink()
    assert f"{path.with_suffix('.png')} is there already" in refused(
        calibrate, folder, "--camera-name", "eye"
    )


def test_a_file_that_comes_during_the_work_is_left_and_the_result_beside_it(
    calibrate, folder, monkeypatch, tmp_path
):
    output, coverage = tmp_path / "eye.yaml", tmp_path / "eye.png"

    def work(*arguments):
        for path in (output, tmp_path / "eye-1.yaml", coverage):
            path.write_text("another's")
        return solve(*arguments)

    monkeypatch.setattr(calibrate_headless, "calibrate", work)
    code, printed = calibrate(folder, "--output", output)
    assert code == 0, printed
    assert_found(tmp_path / "eye-2.yaml")
    assert cv2.imread(str(tmp_path / "eye-1.png")).shape == (480, 640, 3)
    lines = printed.splitlines()
    for path, used in ((output, "eye-2.yaml"), (coverage, "eye-1.png")):
        assert path.read_text() == "another's"
        assert f"{path} has come meanwhile and is not replaced" in lines
        assert any(line.endswith(f" in {tmp_path / used}") for line in lines), printed


def test_from_a_glob_and_a_video_and_by_force(calibrate, images, folder, tmp_path):
    video, output = tmp_path / "more.avi", tmp_path / "eye.yaml"
    writer = cv2.VideoWriter(
        str(video), cv2.CAP_FFMPEG, cv2.VideoWriter_fourcc(*"FFV1"), 30, (640, 480)
    )
    for image in images[5:]:
        writer.write(image)
    writer.release()
    output.write_text("old")
    code, printed = calibrate(folder / "0[0-4].png", video, "--output", output, "--force")
    assert code == 0, printed
    assert f"{COUNT} images: {COUNT} used" in printed and f"  {video}, frame 4: 0." in printed
    assert_found(output)


@pytest.mark.parametrize("compressed", [False, True])
def test_from_a_bag(calibrate, images, tmp_path, compressed):
    bag, output = tmp_path / "eye.bag", tmp_path / "eye.yaml"
    with rosbag.Bag(str(bag), "w") as made:
        for number, image in enumerate(images):
            sent = message(image, "bgr8", padding=4)
            if compressed:
                data = cv2.imencode(".png", image)[1].tobytes()
                sent = CompressedImage(format="bgr8; png compressed bgr8", data=data)
            made.write(IMAGE, sent, rospy.Time(number + 1))
        made.write("/\x1b[2J\n", sent, rospy.Time(number + 1))
    code, printed = calibrate("--bag", bag, "--image", IMAGE, "--output", output)
    assert code == 0, printed
    assert_found(output)
    assert f"has no images on '/other', but on /\\x1b[2J\\n, {IMAGE}" in refused(
        calibrate, "--bag", bag, "--image", "/other", "--output", tmp_path / "other.yaml"
    )


def test_images_that_cannot_be_used_are_named_and_skipped(calibrate, images, folder, tmp_path):
    names = "small.png", "broken.png", "gone\x1b[2J\n.png"
    small, broken, gone = (tmp_path / name for name in names)
    cv2.imwrite(str(small), images[0][::2, ::2])
    broken.write_bytes((folder / "00.png").read_bytes()[:1000])
    gone.symlink_to(tmp_path / "nowhere")
    code, printed = calibrate(folder, tmp_path / "*.png", "--output", tmp_path / "eye.yaml")
    assert code == 0, printed
    lines = printed.splitlines()
    assert f"skipped {small}: it has 320x240, the images before 640x480" in lines
    assert f"skipped {broken}: PNG of 1000 bytes is damaged or truncated" in lines
    assert f"skipped {tmp_path}/gone\\x1b[2J\\n.png: No such file or directory" in lines
    assert any(line.startswith(f"{COUNT + 3} images: {COUNT} used, ") for line in lines)
    assert "0 like others, 3 unusable" in printed
    assert_found(tmp_path / "eye.yaml")


def test_unusable_images_of_a_bag_are_named_and_skipped(calibrate, images, tmp_path):
    bag, output = tmp_path / "eye.bag", tmp_path / "eye.yaml"
    gray = cv2.cvtColor(images[0], cv2.COLOR_BGR2GRAY)
    short = message(gray, "mono8")
    short.data = short.data[:-1]
    depths = CompressedImage(format="16UC1; compressedDepth", data=bytes(20))
    bad = [message(np.float32(gray), "32FC1"), message(gray, "mono7"), short]
    with rosbag.Bag(str(bag), "w") as made:
        for number, sent in enumerate([*bad, *(message(one, "bgr8") for one in images)]):
            made.write(IMAGE, sent, rospy.Time(number + 1))
        for number, sent in enumerate([depths, CompressedImage(format="jpeg")]):
            made.write(IMAGE + "/compressedDepth", sent, rospy.Time(number + 1))
    code, printed = calibrate("--bag", bag, "--image", IMAGE, "--output", output)
    assert code == 0, printed
    assert "skipped image 0: 32FC1 has no gray levels of 8 or 16 bits\n" in printed
    assert "skipped image 1: Unrecognized image encoding [mono7]\n" in printed
    assert (
        "skipped image 2: mono8 of 640x480 with 640 bytes to a row, and 307199 in all\n" in printed
    )
    assert f"{COUNT + 3} images: {COUNT} used, " in printed and ", 3 unusable\n" in printed
    assert_found(output)
    code, printed = calibrate(
        "--bag", bag, "--image", IMAGE + "/compressedDepth", "--output", tmp_path / "a.yaml"
    )
    assert code == 1 and "there were no images that can be used" in printed
    assert "skipped image 0: it has depths (compressedDepth)\n" in printed
    assert "skipped image 1: no image that OpenCV can read\n" in printed


def test_live_and_given_to_the_camera(start, tmp_path):
    """From the running camera, and back to it; Ctrl-C ends the recording."""
    url = f"_camera_info_url:=file://{tmp_path}/kept.yaml"
    start("camera_node", "__name:=eye", "_source:=synthetic", "_scene:=calibration", url)
    rospy.wait_for_service("/eye/set_camera_info", support.DEADLINE)
    command = [*BOARD, "--topic", IMAGE, "--set", "/eye", "--coverage", tmp_path / "seen.png"]
    process = start("calibrate_headless.py", *command)
    support.wait_for(lambda: re.search(r": ([6-9]|\d\d) used", process.output()), "six views")
    process.interrupt()
    assert process.exit_code() == 0, process.output()
    assert "set in /eye\n" in process.output()
    assert_found(tmp_path / "kept.yaml")
    kept = yaml.safe_load((tmp_path / "kept.yaml").read_text())
    assert kept["rectification_matrix"]["data"] == [1, 0, 0, 0, 1, 0, 0, 0, 1]
    assert kept["projection_matrix"]["data"][0] == pytest.approx(535, abs=25)
    assert (tmp_path / "seen.png").exists()


def test_shut_down_it_goes_on_with_what_it_has(start, images, tmp_path):
    """While more images come."""
    publisher = rospy.Publisher("/shown", Image, queue_size=1)
    messages = itertools.cycle(message(image, "bgr8") for image in images)
    command = [*BOARD, "--topic", "/shown", "--output", tmp_path / "eye.yaml"]
    process = start("calibrate_headless.py", *command)

    def enough():
        publisher.publish(next(messages))
        return re.search(r": ([6-9]|\d\d) used", process.output())

    support.wait_for(enough, "six views")
    shut_down_subscriber("/shown")
    support.wait_for(lambda: enough() and not process.running(), "its end")
    publisher.unregister()
    assert process.exit_code() == 0, process.output()
    assert_found(tmp_path / "eye.yaml")


@pytest.fixture
def camera():
    """camera(handler): the node /broken has a set_camera_info that does that."""
    services = []

    def make(handler):
        services.append(rospy.Service("/broken/set_camera_info", SetCameraInfo, handler))

    yield make
    for service in services:
        service.shutdown()


def fail(_request):
    raise RuntimeError("disk full")


@pytest.mark.parametrize(
    "handler, reason",
    [
        (lambda _: SetCameraInfoResponse(success=False, status_message="read only"), "read only"),
        (
            lambda _: SetCameraInfoResponse(success=False, status_message="\x1b[2J\nfull"),
            "\\x1b[2J\\nfull",
        ),
        (lambda _: SetCameraInfoResponse(success=False), "refused"),
        (fail, "disk full"),
    ],
)
def test_what_the_camera_refuses_is_not_lost(start, camera, folder, tmp_path, handler, reason):
    """It is in a new file, and the error says how the camera takes it from there."""
    camera(handler)
    kept = tmp_path / "camera_info" / "head_camera-calibrated.yaml"
    command = [*BOARD, folder, "--set", "/broken"]
    if reason == "refused":
        kept.parent.mkdir()
        kept.touch()  # by an earlier run
        kept = kept.with_name("head_camera-calibrated-1.yaml")
    process = start("calibrate_headless.py", *command, env={"ROS_HOME": str(tmp_path)})
    assert process.exit_code() == 1
    *_, saved, coverage, error = process.output().splitlines()
    assert coverage == f"coverage in {kept.with_suffix('.png')}"
    assert saved == f"saved in {kept}"
    assert error.startswith("calibrate_headless.py: /broken/set_camera_info: ") and reason in error
    assert error.endswith(f"start the camera with camera_info_url:=file://{kept}")
    assert_found(kept)


def test_a_camera_that_does_not_run_is_told_before_the_work(start, folder):
    process = start("calibrate_headless.py", *BOARD, folder, "--set", "/nobody")
    assert process.exit_code() == 1
    assert process.output() == (
        "calibrate_headless.py: there is no service /nobody/set_camera_info: does the camera run?\n"
    )


def shut_down_subscriber(topic):
    """As rosnode kill does it: its images come by a node of roscpp beside it."""
    _, subscribers, _ = rosgraph.Master("/test").getSystemState()
    (images,) = dict(subscribers)[topic]
    with contextlib.suppress(OSError):  # it may end before it has answered
        support.node_api(images[: -len("_images")]).shutdown("/test", "killed")


@pytest.mark.parametrize("killed", [False, True])
def test_a_topic_without_images(start, tmp_path, killed):
    process = start("calibrate_headless.py", *BOARD, "--topic", "/none", "--output", tmp_path / "a")
    process.wait_for_output("waiting: no image comes on /none; nobody publishes images there\n")
    shut_down_subscriber("/none") if killed else process.interrupt()
    assert process.exit_code() == 1
    assert "calibrate_headless.py: there were no images" in process.output()


def test_what_is_no_file_is_named_and_nothing_is_made(calibrate, folder, tmp_path):
    """Pipes and devices would keep it for ever; folders are made when there is a result."""
    new = tmp_path / "new" / "folder" / "eye.yaml"
    pipes = [tmp_path / name for name in ("pipe.png", "pipe.mp4", "pipe.bag")]
    for pipe in pipes:
        os.mkfifo(str(pipe))
    for path in (*pipes[1:2], "/dev/zero"):
        error = refused(calibrate, path, "--output", new)
        assert error == f"calibrate_headless.py: {path} cannot be read: it is no file"
    error = refused(calibrate, "--bag", pipes[2], "--image", IMAGE, "--output", new)
    assert error == f"calibrate_headless.py: {pipes[2]} cannot be read: it is no file"
    code, output = calibrate(pipes[0], "--output", new)
    assert code == 1 and f"skipped {pipes[0]}: it is no file\n" in output
    for odd in (pipes[0], "/dev/null"):
        error = refused(calibrate, folder, "--output", odd, "--force")
        assert error == f"calibrate_headless.py: {odd} cannot be written: it is no file"
        error = refused(calibrate, folder, "--output", new, "--coverage", odd, "--force")
        assert error == f"calibrate_headless.py: {odd} cannot be written: it is no file"
    assert not new.parent.parent.exists() and all(pipe.is_fifo() for pipe in pipes)


@pytest.mark.parametrize("phase", ["calibrate", "as_yaml", "coverage_image"])
def test_interrupted_at_its_work_it_leaves_nothing(calibrate, folder, monkeypatch, tmp_path, phase):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(calibrate_headless, phase, interrupt)
    code, output = calibrate(folder, "--output", tmp_path / "new" / "eye.yaml")
    assert code == 130 and "Traceback" not in output
    assert [path.name for path in tmp_path.glob("new/*")] == ["eye.yaml"] * ("saved in" in output)


def test_what_cannot_be_used_is_named(calibrate, images, folder, monkeypatch, tmp_path):
    def error(*arguments):
        return refused(calibrate, *arguments, "--output", tmp_path / "eye.yaml")

    few, empty = sorted(folder.glob("0[0-2].png")), tmp_path / "empty"
    empty.mkdir()
    assert "3 views of the board, 5 are needed at least" in error(*few)
    assert f"{empty}: no images in this folder" in error(empty)
    assert "/no/pictures/*.png: no such file or folder" in error("/no/pictures/*.png")
    assert f"{folder}/notes.txt: no image and no video" in error(folder / "notes.txt")
    broken = tmp_path / "broken.png"
    broken.write_bytes(few[0].read_bytes()[:1000])
    assert "there were no images that can be used" in error(broken)
    gray = tmp_path / "gray.png"
    cv2.imwrite(str(gray), np.full((480, 640), 99, np.uint8))
    code, printed = calibrate(gray, "--output", tmp_path / "eye.yaml")
    assert code == 1 and "1 images: 0 used, 1 without the board" in printed
    assert "no image shows the board well: is --size 8x6 right?" in printed
    assert f"{gray}/x.yaml cannot be written" in refused(
        calibrate, folder, "--output", f"{gray}/x.yaml"
    )
    monkeypatch.setenv("ROS_MASTER_URI", f"http://127.0.0.1:{support.free_port()}")
    assert "no ROS master answers at http://127" in error("--topic", IMAGE)
    assert not (tmp_path / "eye.yaml").exists()


@pytest.mark.parametrize(
    "arguments, reason",
    [
        ([], "the images are from FILE..., --bag or --topic: one of them"),
        (["a.png", "--topic", "/a"], "the images are from FILE..., --bag or --topic"),
        (["--bag", "a.bag"], "--bag and --image belong together"),
        (["a.png", "--size", "8by6"], "--size: '8by6' must be as 8x6, 3 to 99 each"),
        (["a.png", "--size", "2x6"], "--size: '2x6' must be as 8x6, 3 to 99 each"),
        (["a.png", "--square", "0"], "--square: 0 must be above 0 and at most 10"),
        (["a.png", "--marker", "0.01"], "--marker and --dictionary are of charuco"),
        (["a.png", "--board", "charuco"], "a ChArUco board has --marker and --dictionary"),
        (
            ["a.png", "--board", "charuco", "--marker", "0.06", "--dictionary", "4x4_50"],
            "--marker: is 0.06, must be less than --square, 0.05",
        ),
        (
            ["a.png", "--board", "charuco", "--marker", "0.03", "--dictionary", "huge"],
            "dictionary is 'huge', must be one of ",
        ),
        (["a.png", "--most", "3"], "--most: 3 must be from 5 to 1000"),
        (["a.png", "--max-blur", "0"], "--max-blur: 0 must be from 1 to 1000"),
        (["a.png", "--k3", "--model", "equidistant"], "--k3 is of plumb_bob"),
        (["a.png", "--camera-name", "../eye"], "--camera-name: is '../eye', must be letters"),
    ],
)
def test_what_is_no_command_is_refused(calibrate, arguments, reason):
    code, output = calibrate(*arguments)
    assert code == 2 and reason in output, output


def test_help_has_examples(calibrate):
    code, output = calibrate("--help")
    assert code == 0 and "--bag eye.bag --image /usb_cam/image_raw" in output
