"""Shared by tests of what object_recognition_core's clients know: their messages, generated anew.

Its package object_recognition_msgs is not in Debian. Its definitions are in
test/recognition/object_recognition_msgs; the sums that others have published tell that they are.
"""

import importlib
import pathlib
import subprocess
import sys
from typing import Any

import genpy.generator
import rospkg

NAME = "object_recognition_msgs"
DEFINITIONS = pathlib.Path(__file__).resolve().parent.parent / "recognition" / NAME
USED = ("actionlib_msgs", "geometry_msgs", "sensor_msgs", "shape_msgs", "std_msgs")
PUBLISHED = {
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
}


def their_messages(folder: pathlib.Path) -> Any:
    """Generates the Python package, as a catkin workspace would, and returns it."""
    if NAME in sys.modules:
        return sys.modules[NAME]
    actions, package = folder / "actions", folder / NAME
    actions.mkdir()
    generator = pathlib.Path(rospkg.RosPack().get_path("actionlib_msgs"))
    programs = (generator / "scripts" / "genaction.py", "/usr/lib/actionlib_msgs/genaction.py")
    program = next(path for path in map(pathlib.Path, programs) if path.exists())
    action = DEFINITIONS / "action" / "ObjectRecognition.action"
    words = [sys.executable, program, action, "-o", actions]
    subprocess.run(list(map(str, words)), check=True, stdout=subprocess.DEVNULL)
    paths = {NAME: [str(DEFINITIONS / "msg"), str(actions)]}
    for used in USED:
        paths[used] = [str(pathlib.Path(rospkg.RosPack().get_path(used)) / "msg")]
    for kind, generate, files in (
        ("msg", genpy.generator.MsgGenerator(), [*DEFINITIONS.glob("msg/*"), *actions.iterdir()]),
        ("srv", genpy.generator.SrvGenerator(), DEFINITIONS.glob("srv/*")),
    ):
        out = package / kind
        out.mkdir(parents=True)
        names = sorted(map(str, files))
        assert generate.generate_messages(NAME, names, str(out), paths) == 0
        lines = [f"from ._{pathlib.Path(name).stem} import *\n" for name in names]
        (out / "__init__.py").write_text("".join(lines))
    (package / "__init__.py").write_text("")
    sys.path.insert(0, str(folder))
    for kind in ("msg", "srv"):
        importlib.import_module(f"{NAME}.{kind}")
    return sys.modules[NAME]
