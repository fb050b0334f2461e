"""robot_vision.transport in its own process: names, time, bags, restarts, long runs."""

import contextlib
import http.client
import os
import shutil
import signal

import numpy as np
import pytest
import rosbag
import rosgraph
import rospy
import support
from frames import Frames, Source, message, new_topic
from private_memory import IMPORT
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image

IMAGE = np.random.default_rng(5).integers(0, 256, (48, 64, 3), np.uint8)
CYCLES = 1500

HEAD = """
import gc, os, psutil, sys, time
import rospy
from robot_vision.ros import transport
from robot_vision.transport import ImagePublisher, ImageSubscriber
from std_msgs.msg import Header
from std_srvs.srv import Empty
"""
ECHO = f"""{HEAD}
rospy.init_node("echo")
output = ImagePublisher("~out")

def echo(frame):
    print("image", flush=True)
    output.publish(frame.image, frame.encoding)

def pause(_):
    return []

rospy.Service("~pause", Empty, pause)
ImageSubscriber("image", echo, diagnostics=transport.node_diagnostics())
ImageSubscriber("late", lambda _: print("late", flush=True))
print("started", flush=True)
rospy.spin()
"""


@pytest.mark.parametrize(
    "arguments, env, node, topics",
    [
        ([], {}, "/echo", ["/image", "/late"]),
        (["__name:=eyes", "image:=left"], {}, "/eyes", ["/left", "/late"]),
        (["__ns:=/deep/er", "image:=/left"], {}, "/deep/er/echo", ["/left", "/deep/er/late"]),
        (["__ns:=deep", "late:=~mine"], {}, "/deep/echo", ["/deep/image", "/deep/echo/mine"]),
        (["/up/image:=down"], {"ROS_NAMESPACE": "up"}, "/up/echo", ["/up/down", "/up/late"]),
        (["__ns:=/a", "__name:=b", "~out:=out"], {}, "/a/b", ["/a/image", "/a/late"]),
    ],
)
def test_names_are_resolved_as_in_rospy(run_script, arguments, env, node, topics):
    run_script(ECHO, *arguments, env=env)
    output = rospy.resolve_name("/a/out" if "~out:=out" in arguments else node + "/out")
    sources = [Source(topic) for topic in topics]
    for source in sources:
        source.wait_for()
    frames = Frames(output)
    # The publisher knows the subscriber a bit later than that knows the publisher.
    receiver = rospy.get_name() + "_images"
    support.wait_for(lambda: support.sends(node + "_images", output, receiver), output)
    sources[0].send(message(IMAGE, "bgr8"))
    assert np.array_equal(frames.wait()[0].image, IMAGE)
    expected = {name for topic in topics for name in (topic, topic + "/shm")}

    def registered():
        publishers, subscribers, _ = rosgraph.Master("/test").getSystemState()
        names = {topic for topic, nodes in subscribers if node + "_images" in nodes}
        assert names <= expected
        return names == expected and node + "_images" in dict(publishers)[output]

    support.wait_for(registered, "its topics")


def test_a_transport_that_is_not_installed(run_script):
    process = run_script(ECHO, "_image_transport:=semaphore")
    assert process.exit_code() == 1
    assert "image_transport is 'semaphore', must be one that is installed:" in process.output()


def test_a_node_ends_when_its_roscpp_node_is_killed(run_script):
    process = run_script(ECHO)
    process.wait_for_output("started")
    with contextlib.suppress(OSError, http.client.HTTPException):  # if it ends before it answers
        assert support.node_api("/echo_images").shutdown("/test", "killed")[0] == 1
    assert process.exit_code() == 0, process.output()


def test_simulated_time(run_script, diagnostics):
    """Stamps and ages of images come from /clock, and images arrive also while it stands still."""
    clock = rospy.Publisher("/clock", Clock, queue_size=1, latch=True)
    rospy.set_param("/use_sim_time", True)
    run_script(ECHO, "_diagnostic_period:=0.1")
    source, results = Source("/image"), support.Messages("/echo/out", Image)
    source.wait_for()
    support.wait_for(results.connected, "the output")
    sent = 0

    def aged():
        nonlocal sent
        sent += 1
        clock.publish(Clock(rospy.Time(1234, 500000000)))  # rospy may begin after the first one
        image = message(IMAGE, "bgr8")
        image.header.stamp = rospy.Time(1234)
        source.send(image)
        stamp = results.wait(sent)[-1].header.stamp
        age = diagnostics.value("echo", "output age (ms)")
        return (stamp, age) == (rospy.Time(1234, 500000000), "500.000")

    support.wait_for(aged, "a frame that is half a second old")
    clock.unregister()


def test_a_bag_recorded_and_played(start, tmp_path):
    topic = new_topic()
    source, bag = Source(topic), tmp_path / "images.bag"
    record = start(shutil.which("rosbag"), "record", "-l", 5, "-O", bag, topic)
    source.wait_for()
    sent = [np.roll(IMAGE, number, axis=0) for number in range(5)]
    for number, pixels in enumerate(sent):
        image = message(pixels, "bgr8", padding=4)
        image.header.stamp = rospy.Time(100 + number)
        source.send(image)
        rospy.sleep(0.1)  # a bag stores the times of arrival
    assert record.exit_code() == 0, record.output()

    with rosbag.Bag(str(bag)) as recorded:
        assert recorded.get_message_count() == 5

    played = topic + "_played"
    frames = Frames(played)
    play = ["play", "--wait-for-subscribers", "--keep-alive", "-r", 0.4]
    start(shutil.which("rosbag"), *play, bag, f"{topic}:={played}")
    last = rospy.Time(104)  # on a busy machine it may take the place of one before it
    support.wait_for(
        lambda: any(frame.header.stamp == last for frame in frames.received),
        "the last image",
    )
    stamps = [frame.header.stamp for frame in frames.received]
    assert stamps == sorted(set(stamps))
    for frame in frames.received:
        assert np.array_equal(frame.image, sent[frame.header.stamp.secs - 100])


NUMBERED = f"""{HEAD}
rospy.init_node("numbered")
output = ImagePublisher("~out")

def echo(frame):
    output.publish(frame.image, frame.encoding, Header(0, frame.header.stamp, str(os.getpid())))

ImageSubscriber("image", echo)
rospy.spin()
"""
LAUNCH = """
<launch>
  <node name="numbered" pkg="robot_vision" type="camera_node" respawn="true"
        launch-prefix="/usr/bin/python3 {}"/>
</launch>
"""


def test_a_node_that_is_killed_and_respawned(start, tmp_path):
    script, launch = tmp_path / "numbered.py", tmp_path / "numbered.launch"
    script.write_text(NUMBERED)
    launch.write_text(LAUNCH.format(script))
    start("camera_node", "__name:=camera", "_source:=synthetic", "~image_raw:=/image")
    start(shutil.which("roslaunch"), launch)
    results = support.Messages("/numbered/out", Image)
    results.wait()
    killed = set()
    for _ in range(2):
        pid = support.wait_for(
            lambda: {one.header.frame_id for one in list(results.received)} - killed, "a frame"
        ).pop()
        os.kill(int(pid), signal.SIGKILL)
        killed.add(pid)
    support.wait_for(
        lambda: results.received[-1].header.frame_id not in killed, "the successor's frames"
    )


def test_a_master_that_is_restarted(start, run_script):
    def frames_come(of, name):
        count = of.output().count(name)
        support.wait_for(lambda: of.output().count(name) > count, name)

    camera = ["_source:=synthetic", "_image_width:=160", "_image_height:=120"]
    master = support.Master(start)
    start("camera_node", "__name:=camera", "~image_raw:=/image", *camera, env=master.env)
    echo = run_script(ECHO, env=master.env)
    frames_come(echo, "image")
    master.end()
    frames_come(echo, "image")
    master.begin()
    support.wait_for(lambda: "/late" in dict(master.api.getSystemState()[1]), "the subscription")
    start("camera_node", "__name:=late", "~image_raw:=/late", *camera, env=master.env)
    frames_come(echo, "late")
    second = run_script(ECHO, "__name:=second", "image:=/echo/out", env=master.env)
    frames_come(second, "image")
    frames_come(echo, "image")

    def registered():
        """What rospy registers again by itself, while roscpp's node is there already."""
        topics, _, services = map(dict, master.api.getSystemState())
        return services.get("/echo/pause") == ["/echo"] and "/echo" in topics.get("/rosout", [])

    support.wait_for(registered, "the service and the log")
    for process in (echo, second):
        process.interrupt()
        assert process.exit_code() == 0, process.output()
    assert "_images" not in str(master.api.getSystemState())


CYCLE = f"""{HEAD}{IMPORT}
rospy.init_node("cycles")
process = psutil.Process()
came = []
for cycle in range({CYCLES} + 1):
    images = ImageSubscriber("image", came.append)
    while cycle % 50 == 0 and not came:  # in the other cycles it goes before it has quite come
        time.sleep(0.001)
    images.unregister()
    came.clear()
    if cycle % 50 == 0:
        print(cycle, private_memory(process.pid), process.num_threads(), flush=True)
deadline = time.monotonic() + 30
while process.num_fds() >= 40 and time.monotonic() < deadline:  # half a connection ends by itself
    time.sleep(0.1)
print("files", process.num_fds(), flush=True)
"""


def test_subscribing_and_unsubscribing_1500_times(start, run_script):
    size = ["_image_width:=160", "_image_height:=120"]
    start("camera_node", "__name:=camera", "_source:=synthetic", "_always_subscribe:=true", *size)
    process = run_script(CYCLE, "image:=/camera/image_raw")
    assert process.exit_code(600) == 0, process.output()
    print(process.output())
    *readings, files = [line.split() for line in process.output().splitlines()]
    assert int(readings[-1][0]) == CYCLES
    _, used, threads = np.array(readings, float).T
    # Single readings differ by frames on their way and by threads that are about to end, so the
    # lowest ones count. A leak of one frame per cycle would be 41 MiB.
    quarter = len(used) // 4
    growth = min(used[-quarter:]) - min(used[quarter : 2 * quarter])
    assert growth < 0.6, f"{growth:.1f} MiB in {CYCLES // 2} cycles: {np.round(used, 1)}"
    assert min(threads[-quarter:]) == min(threads[quarter : 2 * quarter])
    assert int(files[1]) < 40
