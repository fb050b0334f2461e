"""The command pick_color.py, which finds the range around a colour for hsv_tracker."""

import argparse
import queue
import re
import sys
from typing import List, Optional, Sequence, Tuple

import numpy as np
import rospy

from .. import bgr_of_hsv, color_spaces, range_around, to_space
from ..common.arguments import command_parser, number_within
from ..common.commands import run_command
from ..common.image_files import load_image, upright
from ..ros.startup import become_node
from ..ros.transport import ImageSubscriber
from .color_file import save_colors
from .colors import HUES, Color, as_yaml, median_color, outside, title_of

EXAMPLES = """examples:
  pick_color.py --hex '#1e90ff'
  pick_color.py --rgb 30 144 255 --margin 15
  pick_color.py image.png --at 320 240
  pick_color.py image.png --region 300 220 40 40 --save hsv_tracker.yaml --name blue
  pick_color.py --topic /usb_cam/image_raw --at 320 240
  pick_color.py --hex '#1e90ff' --space lab
"""


def main() -> int:
    """Runs the command and returns its exit code."""
    arguments = _parse(rospy.myargv(sys.argv)[1:])
    return run_command("pick_color.py", lambda: _pick(arguments))


def _pick(arguments: argparse.Namespace) -> None:
    bgr, picked = _color(arguments)
    space = arguments.space
    color = range_around(picked, space, arguments.margin)
    known = f"BGR {bgr}, " if bgr and space != "bgr" else ""
    print(f"{known}{title_of(space)} {picked}; for the colors of hsv_tracker:")
    print(f"  {arguments.name or 'name'}: {as_yaml(color)}")
    problem = outside(picked, color)
    if problem:
        print(problem)
    if arguments.save:
        if problem and not arguments.force:
            raise ValueError(f"{arguments.save}: not saved; --force saves this range all the same")
        save_colors(arguments.save, {arguments.name: color})
        print("saved in", arguments.save)


def _parse(command: Sequence[str]) -> argparse.Namespace:
    parser = command_parser(
        "pick_color.py",
        "Prints the range around a colour, as hsv_tracker's parameter file has it, in HSV (hue 0 "
        "to 179, saturation and value 0 to 255) or another space of OpenCV.",
        EXAMPLES,
    )
    _add_colors(parser)
    parser.add_argument(
        "--margin",
        type=number_within(int, 0, 90),
        metavar="M",
        help="hues more and less, 0 to 90 (default: 10); of the other channels in a space without "
        "hue (default: 20)",
    )
    parser.add_argument(
        "--space",
        choices=color_spaces(),
        default="hsv",
        help="of the range (default: %(default)s)",
    )
    parser.add_argument("--save", metavar="FILE", help="put it into this YAML file; with --name")
    parser.add_argument("--name", help="of the colour in the file")
    parser.add_argument(
        "--force", action="store_true", help="save a range that does not hold the colour, too"
    )
    parser.add_argument(
        "--timeout",
        type=number_within(float, 0.0, 3600.0, above_low=True),
        default=10.0,
        metavar="S",
        help="how long to wait for --topic (default: %(default)g s)",
    )
    arguments = parser.parse_args(command)
    if arguments.hsv and arguments.hsv[0] >= HUES:
        parser.error(f"argument --hsv: the hue is {arguments.hsv[0]}, must be from 0 to 179")
    if bool(arguments.at or arguments.region) != bool(arguments.topic or arguments.image):
        parser.error("an image or --topic needs --at or --region, and a colour has neither")
    if arguments.save and not arguments.name:
        parser.error("--save needs --name")
    return arguments


def _add_colors(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments that choose the colour."""
    channels = {"nargs": 3, "type": number_within(int, 0, 255)}
    source = parser.add_argument_group("the colour, one of").add_mutually_exclusive_group(
        required=True
    )
    source.add_argument("--bgr", **channels, metavar=("B", "G", "R"), help="0 to 255 each")
    source.add_argument("--rgb", **channels, metavar=("R", "G", "B"), help="0 to 255 each")
    source.add_argument("--hex", type=_hex_color, metavar="'#RRGGBB'", help="as web pages have it")
    source.add_argument("--hsv", **channels, metavar=("H", "S", "V"), help="H up to 179")
    source.add_argument("--topic", help="the next image of a topic; with --at or --region")
    source.add_argument("image", nargs="?", help="an image file; with --at or --region")
    place = parser.add_argument_group("where in the image").add_mutually_exclusive_group()
    place.add_argument("--at", nargs=2, type=int, metavar=("X", "Y"), help="a pixel")
    place.add_argument(
        "--region",
        nargs=4,
        type=int,
        metavar=("X", "Y", "W", "H"),
        help="a rectangle: the median of its colours",
    )


def _hex_color(text: str) -> List[int]:
    """Converts '#RRGGBB' to [B, G, R]."""
    if not re.fullmatch("#?[0-9a-fA-F]{6}", text):
        raise argparse.ArgumentTypeError(f"'{text}' must be six hexadecimal digits: '#1e90ff'")
    return list(bytes.fromhex(text[-6:]))[::-1]


def _color(arguments: argparse.Namespace) -> Tuple[Optional[Color], Color]:
    """Returns the chosen colour in BGR and in --space; BGR is None for --hsv, and for a median."""
    space = arguments.space
    if arguments.hsv:
        hsv = tuple(arguments.hsv)
        return None, hsv if space == "hsv" else to_space(bgr_of_hsv(hsv), space)
    if arguments.topic or arguments.image:
        if arguments.topic:
            image = _first_image(arguments.topic, arguments.timeout)
        else:
            image = load_image(arguments.image, upright)
        part = _crop(image, arguments.region or [*arguments.at, 1, 1])
        if arguments.region:
            return None, median_color(part, space)
        bgr = part[0, 0].tolist()
    else:
        bgr = arguments.bgr or arguments.hex or arguments.rgb[::-1]
    return tuple(bgr), to_space(bgr, space)


def _crop(image: np.ndarray, region: Sequence[int]) -> np.ndarray:
    x, y, width, height = region
    rows, columns = image.shape[:2]
    if not (0 <= x < x + width <= columns and 0 <= y < y + height <= rows):
        raise ValueError(
            f"x {x}, y {y}, width {width}, height {height}: "
            f"not inside of the image of {columns}x{rows}"
        )
    return image[y : y + height, x : x + width]


def _first_image(topic: str, seconds: float) -> np.ndarray:
    """Returns the next image of a topic, BGR."""
    become_node("pick_color")
    frames: queue.Queue[np.ndarray] = queue.Queue()
    subscriber = ImageSubscriber(topic, lambda frame: frames.put(frame.image), encoding="bgr8")
    try:
        return frames.get(timeout=seconds)
    except queue.Empty:
        state = "was usable" if subscriber.received else "came"
        nobody = "" if subscriber.get_num_connections() else "; nobody publishes images there"
        raise TimeoutError(
            f"{subscriber.topic}: no image {state} within {seconds:g} s{nobody}"
        ) from None
    finally:
        subscriber.unregister()
