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


def test_no_module_hides_what_its_package_exports():
    """An import of a module sets the package's attribute of its name."""
    program = """
import importlib, pkgutil, types, robot_vision
packages = [robot_vision]
for found in pkgutil.walk_packages(robot_vision.__path__, "robot_vision."):
    module = importlib.import_module(found.name)
    packages += [module] if found.ispkg else []
for package in packages:
    for name in getattr(package, "__all__", ()):
        if isinstance(getattr(package, name), types.ModuleType):
            print(package.__name__, name)
"""
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (result.returncode, result.stdout) == (0, ""), result.stderr
