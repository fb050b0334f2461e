"""Nodes and nodelets of a process come and go while frames flow; nothing is left of them."""

import numpy as np
from private_memory import IMPORT

CYCLES = 100
SCRIPT = f"""{IMPORT}
import gc, psutil, time
import rospy
from robot_vision.ros.context import LoadedContext, active
from robot_vision.ros.node_images import process_runtime
from robot_vision.ros.transport import node_diagnostics
from robot_vision.transport import ImagePublisher, ImageSubscriber

rospy.init_node("cycles")
runtime, process = process_runtime(), psutil.Process()
size = {{"image_width": 320, "image_height": 240}}
rospy.set_param("/eye", {{"source": "synthetic", "framerate": 100.0, **size}})
rospy.set_param("/filter", {{"always_subscribe": True}})
runtime.load_nodelet("/eye", "robot_vision/camera", {{}}, [])
stayed = []
ImageSubscriber("/eye/image_raw", lambda frame: stayed.append(frame.header.seq), "mono8")

def wait(condition, what):
    deadline = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < deadline, what
        time.sleep(0.001)

for cycle in range({CYCLES} + 1):
    remappings = {{"/image": "/eye/image_raw"}}
    runtime.load_nodelet("/filter", "robot_vision/brightness", remappings, [])
    came = []
    with_frame = lambda frame: (came.append(frame.header.seq), time.sleep(0.02))
    for name, kind in (("/node_a", "mono8"), ("/node_b", "rgb8")):
        node = LoadedContext(name, remappings, print)
        with active(node):
            output = ImagePublisher("~out")
            ImageSubscriber("image", with_frame, kind, diagnostics=node_diagnostics())
            ImageSubscriber("/filter/processed_image", with_frame, kind)
        before = len(came)
        wait(lambda: len(came) > before, "a frame")
        node.end()  # its callback is most likely running
    count = len(stayed)
    wait(lambda: len(stayed) > count, "a frame of the node that stays")
    assert runtime.unload_nodelet("/filter")
    if cycle % 10 == 0:
        gc.collect()
        memory = private_memory(process.pid)
        print(cycle, memory, process.num_threads(), process.num_fds(), flush=True)
assert runtime.nodelets() == ["/eye"]
"""


def test_nodes_and_nodelets_come_and_go_100_times(start, run_script):
    process = run_script(SCRIPT)
    assert process.exit_code(400) == 0, process.output()
    print(process.output())
    lines = [line.split() for line in process.output().splitlines()]
    readings = np.array([list(map(float, line)) for line in lines if line[0].isdigit()])
    assert readings[-1][0] == CYCLES
    memory, threads, files = readings[2:, 1], readings[2:, 2], readings[2:, 3]
    # Single readings differ by frames on their way, of 0.2 MiB each, and by what is about to end.
    # In some of the first 50 cycles the allocator takes memory for threads.
    assert min(memory[-3:]) - min(memory[3:6]) < 1.2, memory
    assert min(threads[-4:]) - min(threads[:4]) <= 1, threads
    assert min(files[-4:]) <= min(files[:4]), files
