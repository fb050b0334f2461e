"""Nodelets are loaded and unloaded in a running manager, which must not die or grow."""

import cv2
import numpy as np
import pytest
import rospy
import support
from private_memory import GIVES_BACK, private_memory
from sensor_msgs.msg import Image

# How often each is loaded and unloaded, and after how many of these cycles it has to make an image
# again; in the others it is unloaded before it has fully started. What the last ones share with
# those before them is not tested as often.
CYCLES = {
    **dict.fromkeys(("camera", "brightness", "edge_detector"), (100, 10)),
    **dict.fromkeys(("filter", "dense_flow", "spectrum", "segmenter"), (25, 1)),
}


@pytest.fixture
def manager(start):
    return support.NodeletManager(start, env=GIVES_BACK)


def growth_per_cycle(used):
    """The slope of a line through readings of memory, one a cycle, of which some are far off.

    It is the median of the slopes between all pairs (Theil and Sen).
    """
    first, second = np.triu_indices(len(used), 1)
    return np.median((np.take(used, second) - np.take(used, first)) / (second - first))


@pytest.mark.parametrize("kind", CYCLES)
def test_loads_and_unloads_under_traffic(manager, kind, tmp_path):
    # Not the synthetic scene: it takes longer to be made than all else of a load, and its renderer
    # takes more memory while its things come nearer.
    cv2.imwrite(str(tmp_path / "still.ppm"), np.full((480, 640, 3), 90, np.uint8))
    still = {"source": str(tmp_path), "loop": True, "always_subscribe": True}
    for name in ("/source", "/cycled"):
        rospy.set_param(name, still)
    assert manager.load("/source", "camera")
    output = "/cycled/" + ("image_raw" if kind == "camera" else "processed_image")
    used = []
    cycles, apart = CYCLES[kind]
    for cycle in range(cycles):
        assert manager.load("/cycled", kind, {"/image": "/source/image_raw"}), cycle
        if cycle % apart == 0:
            frames = support.Messages(output, Image)
            frames.wait()
            frames.close()
        assert manager.unload("/cycled"), cycle
        assert manager.process.running(), manager.process.output()
        used.append(private_memory(manager.process.pid))
    # Single readings differ by frames on their way, and the heap grows in the first cycles. A leak
    # would show as a slope: 0.9 MiB for a 640x480 frame in each cycle.
    slope = growth_per_cycle(used[cycles // 3 :])
    assert slope < (0.1 if apart > 1 else 0.5), f"{slope:.2f} MiB a cycle: {np.round(used, 1)}"
    assert manager.loaded() == {"/source"}


def test_a_nodelet_that_cannot_start_does_not_harm_the_manager(manager):
    rospy.set_param("/good/source", "synthetic")
    assert manager.load("/good", "camera")
    # The last one fails after its services and publishers have been made.
    for kind, parameters, message in [
        ("brightness", {"gain": 99}, "gain is 99, must be from 0 to 10"),
        ("camera", {"source": "/no/such/file.mp4"}, "/no/such/file.mp4: no such file or folder"),
        ("edge_detector", {"always_subscribe": "perhaps"}, "must be true or false"),
    ]:
        rospy.set_param("/bad", parameters)
        with pytest.raises(rospy.ServiceException):
            manager.load("/bad", kind)
        manager.process.wait_for_output(message)
        assert manager.loaded() == {"/good"}
    support.Messages("/good/image_raw", Image).wait(3)


def test_a_source_without_a_good_frame_ends_once(manager, diagnostics, tmp_path):
    for name in ("a.jpg", "b.jpg"):
        (tmp_path / name).write_bytes(b"\xff\xd8\xff\xe0 half a JPEG")
    rospy.set_param("/damaged", {"source": str(tmp_path), "loop": True, "always_subscribe": True})
    assert manager.load("/damaged", "camera")
    error = f"{tmp_path}: none of its images can be read"
    support.wait_for(lambda: diagnostics.next("damaged").message == error, "the end")
    for _ in range(2):
        assert diagnostics.next("damaged").message == error
    assert manager.process.output().count(error) == 1
    assert diagnostics.value("damaged", "frames refused") == "2"


def test_frames_go_from_nodelet_to_nodelet_inside_the_process(manager):
    rospy.set_param("/camera", {"source": "synthetic"})
    rospy.set_param("/brightness", {"always_subscribe": True})
    rospy.set_param("/edges", {"always_subscribe": True})
    assert manager.load("/camera", "camera")
    assert manager.load("/brightness", "brightness", {"/image": "/camera/image_raw"})
    assert manager.load("/edges", "edge_detector", {"/image": "/brightness/processed_image"})

    def transports(topic):
        _, _, connections = support.node_api(manager.name).getBusInfo("/test")
        return {transport for _, _, _, transport, name, *_ in connections if name == topic}

    for topic in ("/camera/image_raw", "/brightness/processed_image"):
        assert support.wait_for(lambda: transports(topic), topic) == {"INTRAPROCESS"}  # noqa: B023


def test_a_manager_with_all_nodelets_ends_on_sigint(manager):
    rospy.set_param("/camera", {"source": "synthetic", "always_subscribe": True})
    topic = "/camera/image_raw"
    for kind in CYCLES:  # each takes the images of the one before
        assert manager.load(f"/{kind}", kind, {"/image": topic})
        topic = topic if kind == "camera" else f"/{kind}/processed_image"
    support.Messages(topic, Image).wait(3)
    manager.process.interrupt()
    assert manager.process.exit_code() == 0, manager.process.output()
