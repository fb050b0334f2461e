"""Shared by tests of what clients of other packages know: their messages, generated anew.

These packages are not in Debian. Their definitions are in this tree; the md5 sums that others have
published tell that they are theirs.
"""

import importlib
import pathlib
import subprocess
import sys
from typing import Any, Dict, List

import genpy.generator
import rospkg

TESTS = pathlib.Path(__file__).resolve().parent.parent
DEFINITIONS = {
    "object_recognition_msgs": TESTS / "recognition",
    "darknet_ros_msgs": TESTS / "dnn",
    "vision_msgs": TESTS / "dnn",
}
USED = ("actionlib_msgs", "geometry_msgs", "sensor_msgs", "shape_msgs", "std_msgs")
PUBLISHED = {  # of darknet_ros_msgs 1.1.5, and of vision_msgs 0.0.1, which is Noetic's
    "object_recognition_msgs": {
        "GetObjectInformation": "dd7d344324fd86c32836f4fe1bc7b322",
        "ObjectInformation": "921ec39f51c7b927902059cf3300ecde",
        "ObjectRecognitionAction": "7d8979a0cf97e5078553ee3efee047d2",
        "ObjectRecognitionGoal": "49bea2f03a1bba0ad05926e01e3525fa",
        "ObjectRecognitionResult": "868e41288f9f8636e2b6c51f1af6aa9c",
        "ObjectType": "ac757ec5be1998b0167e7efcda79e3cf",
        "RecognizedObject": "f92c4cb29ba11f26c5f7219de97e900d",
        "RecognizedObjectArray": "bad6b1546b9ebcabb49fb3b858d78964",
        "Table": "39efebc7d51e44bd2d72f2df6c7823a2",
        "TableArray": "d1c853e5acd0ed273eb6682dc01ab428",
    },
    "darknet_ros_msgs": {
        "BoundingBoxes": "004f6f4f48a741582d10735997905846",
        "ObjectCount": "123675bf4420958597b5a78cb3800a1f",
    },
    "vision_msgs": {
        "BoundingBox2D": "9ab41e2a4c8627735e5091a9abd68b02",
        "Detection2D": "9e11092151fa150724a255fbac727f3b",
    },
}


def foreign_messages(package: str, folder: pathlib.Path) -> Any:
    """Generates a Python package, as a catkin workspace would, in a folder, and returns it."""
    if package in sys.modules:
        return sys.modules[package]
    definitions = DEFINITIONS[package] / package
    actions = folder / f"actions of {package}"
    actions.mkdir()
    for action in definitions.glob("action/*"):
        _split_action(action, actions)
    paths = {package: [str(definitions / "msg"), str(actions)]}
    for used in USED:
        paths[used] = [str(pathlib.Path(rospkg.RosPack().get_path(used)) / "msg")]
    kinds = {
        "msg": (genpy.generator.MsgGenerator(), [*definitions.glob("msg/*"), *actions.iterdir()]),
        "srv": (genpy.generator.SrvGenerator(), [*definitions.glob("srv/*")]),
    }
    kinds = {kind: one for kind, one in kinds.items() if one[1]}
    for kind, (generator, files) in kinds.items():
        _generate(generator, package, sorted(files), folder / package / kind, paths)
    (folder / package / "__init__.py").write_text("")
    sys.path.insert(0, str(folder))
    for kind in kinds:
        importlib.import_module(f"{package}.{kind}")
    return sys.modules[package]


def _split_action(action: pathlib.Path, out: pathlib.Path) -> None:
    """Writes the messages of an action."""
    package = pathlib.Path(rospkg.RosPack().get_path("actionlib_msgs"))
    programs = (package / "scripts" / "genaction.py", "/usr/lib/actionlib_msgs/genaction.py")
    program = next(path for path in map(pathlib.Path, programs) if path.exists())
    words = [sys.executable, program, action, "-o", out]
    subprocess.run(list(map(str, words)), check=True, stdout=subprocess.DEVNULL)


def _generate(
    generator: Any,
    package: str,
    files: List[pathlib.Path],
    out: pathlib.Path,
    paths: Dict[str, List[str]],
) -> None:
    out.mkdir(parents=True)
    assert generator.generate_messages(package, list(map(str, files)), str(out), paths) == 0
    lines = [f"from ._{path.stem} import *\n" for path in files]
    (out / "__init__.py").write_text("".join(lines))
