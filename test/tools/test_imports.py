"""What starts with every node: each import makes all of them start later."""

import subprocess
import sys


def test_a_node_does_without_rosdep():
    program = "import sys, robot_vision.color.hsv_tracker; print(*sys.modules)"
    result = subprocess.run(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    modules = result.stdout.split()
    assert "dynamic_reconfigure.encoding" in modules, result.stdout
    assert "rosdep2" not in modules
