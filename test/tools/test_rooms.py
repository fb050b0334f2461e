"""The order of the rooms, which is part of make lint."""

import pathlib
import shutil
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FILES = {
    "src/core/CMakeLists.txt": "add_sources(${PROJECT_NAME} image)\nadd_sources(lib camera)\n",
    "src/ros/CMakeLists.txt": "add_sources(${library} params)\nadd_sources(${library} images)\n",
    "src/core/image/jpeg.cpp": '#include "core/image/png.hpp"\n#include <vector>\n',
    "src/core/camera/a.hpp": "class Candidate : public Other\n{\nclass Source;\n",
    "src/core/camera/source.cpp": '#include "robot_vision/image/jpeg.hpp"\n',
    "src/ros/images/message.cpp": '#include "robot_vision/camera/source.hpp"\n',
    "src/robot_vision/common/files.py": "import os\n",
    "src/robot_vision/color/colors.py": "from ..common.files import os\nfrom .. import _core\n",
    "src/robot_vision/motion/gallery.py": "from ..color import colors\nfrom . import views\n",
    "src/robot_vision/motion/views.py": "",
    "src/robot_vision/ball/tracker.py": "",
}


def check(folder, path="", line=""):
    """What tools/check_rooms says of a package with one more line in a file: exit code, lines."""
    for name, text in {**FILES, path or "README.md": FILES.get(path, "") + line}.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    (folder / "include").mkdir()
    (folder / "tools").mkdir()
    tool = shutil.copy(str(ROOT / "tools/check_rooms"), str(folder / "tools"))
    result = subprocess.run(
        [sys.executable, tool], capture_output=True, text=True, check=False, cwd="/"
    )
    return result.returncode, result.stderr.splitlines()


def test_rooms_use_themselves_and_those_before_them(tmp_path):
    assert check(tmp_path) == (0, [])


@pytest.mark.parametrize(
    "path, line, said",
    [
        ("src/core/image/jpeg.cpp", '#include "core/camera/source.hpp"', "a later room"),
        ("src/core/image/jpeg.cpp", '#include "robot_vision/camera/source.hpp"', "a later room"),
        ("src/core/image/jpeg.cpp", "#include <ros/ros.h>", "which is ROS'"),
        ("src/core/camera/b.hpp", "struct Candidate\n{", "Candidate is also a type of src/core/ca"),
        ("src/core/image/jpeg.cpp", "#include <tf2/utils.h>", "which is ROS'"),
        ("src/core/image/jpeg.cpp", '#include "ros/images/message.hpp"', "which is ROS'"),
        ("src/core/depth/depth.cpp", "", "does not list the room depth"),
        ("src/ros/params/params.cpp", '#include "ros/images/message.hpp"', "a later room"),
        ("src/ros/images/message.cpp", '#include "core/image/jpeg.hpp"', "a private header"),
        ("src/nodelets/one.cpp", '#include "core/image/jpeg.hpp"', "a private header"),
        ("src/robot_vision/common/files.py", "from ..color import colors", "a later room"),
        ("src/robot_vision/common/files.py", "from .. import color", "a later room"),
        ("src/robot_vision/ball/tracker.py", "from ..motion.views import x", "a later room"),
        ("src/robot_vision/ball/tracker.py", "from robot_vision.motion import x", "a later room"),
        ("src/robot_vision/ball/tracker.py", "import robot_vision.motion.views", "a later room"),
    ],
)
def test_what_is_used_against_the_order_is_named(tmp_path, path, line, said):
    code, lines = check(tmp_path, path, line + "\n")
    assert code == 1
    assert len(lines) == 1 and lines[0].startswith(path) and said in lines[0]
