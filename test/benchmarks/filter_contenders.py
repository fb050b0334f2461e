"""Chains of the node filter, and the nodes of opencv_apps that do the same."""

from typing import Dict, List, NamedTuple, Tuple

from measuring import Bench, Command, Contender, Contenders
from node_commands import IMAGE, TOPIC, node
from results import Size, Target

SIZE = (1920, 1080)  # px, of the images for which there are figures to beat
EACH, SUM = 1.0, 1 / 2  # of their CPU time, that ours may take at most
ALL = "Filter: all of these, added up"


class Pair(NamedTuple):
    """A chain with its settings, and a node of opencv_apps with those that make it do the same.

    Settings are words as of a command line, private parameters without the underscore.
    """

    chain: str
    ours: str
    kind: str
    theirs: str


SMOOTH = "filter_type:={} kernel_size:=7"
CANNY = "canny_threshold1:=100 canny_threshold2:=200 apertureSize:=3"
# Their edges are those of an image that was smoothed by 3 px first.
SMOOTH_GRAY, SMOOTHED = "gaussian,gray", "gaussian_size:=3"
RANGE = "color_range_low_{0}:={1} color_range_high_{0}:={2}"


def ranges(space: str, *spans: Tuple[int, int]) -> str:
    """The settings of color_range for the least and the largest value of each channel."""
    words = (RANGE.format(channel, *span) for channel, span in enumerate(spans, 1))
    return " ".join([f"color_range_space:={space}", *words])


# By what is done. The hues of opencv_apps are in degrees, twice the numbers of OpenCV.
PAIRS: Dict[str, Pair] = {
    "box": Pair("box", "box_size:=7", "smoothing", SMOOTH.format(0)),
    "Gaussian": Pair("gaussian", "gaussian_size:=7", "smoothing", SMOOTH.format(1)),
    "median": Pair("median", "median_size:=7", "smoothing", SMOOTH.format(2)),
    "bilateral": Pair(
        "bilateral",
        "bilateral_diameter:=7 bilateral_sigma_color:=14 bilateral_sigma_space:=3",
        "smoothing",
        SMOOTH.format(3),
    ),
    "Sobel edges": Pair(f"{SMOOTH_GRAY},gradient", SMOOTHED, "edge_detection", "edge_type:=0"),
    "Laplacian edges": Pair(f"{SMOOTH_GRAY},laplacian", SMOOTHED, "edge_detection", "edge_type:=1"),
    "Canny edges": Pair(
        f"{SMOOTH_GRAY},box,canny",
        f"{SMOOTHED} box_size:=3 canny_low:=100 canny_high:=200",
        "edge_detection",
        f"edge_type:=2 {CANNY}",
    ),
    "threshold": Pair("threshold", "threshold_value:=150", "threshold", "threshold:=150"),
    "half the size": Pair(
        "pyramid_down", "pyramid_down_levels:=1", "pyramids", "pyramids_type:=1 num_of_pyramids:=1"
    ),
    "range of RGB": Pair(
        "color_range",
        ranges("bgr", (20, 150), (100, 200), (50, 250)),
        "rgb_color_filter",
        "b_limit_min:=20 b_limit_max:=150 g_limit_min:=100 g_limit_max:=200 "
        "r_limit_min:=50 r_limit_max:=250",
    ),
    "range of HSV": Pair(
        "color_range",
        ranges("hsv", (5, 25), (80, 255), (80, 255)),
        "hsv_color_filter",
        "h_limit_min:=10 h_limit_max:=50 s_limit_min:=80 s_limit_max:=255 "
        "v_limit_min:=80 v_limit_max:=255",
    ),
    "range of HLS": Pair(
        "color_range",
        ranges("hls", (5, 25), (60, 200), (80, 255)),
        "hls_color_filter",
        "h_limit_min:=10 h_limit_max:=50 l_limit_min:=60 l_limit_max:=200 "
        "s_limit_min:=80 s_limit_max:=255",
    ),
    "two images": Pair(
        "blend",
        f"blend_weight:=0.5 use_second:=true second:={TOPIC}",
        "adding_images",
        f"alpha:=0.5 approximate_sync:=false image1:={TOPIC} image2:={TOPIC}",
    ),
}


def settings(words: str) -> Command:
    """The words as a command line has them: a topic is remapped, all else is a parameter."""
    return [word if ":=/" in word else "_" + word for word in words.split()]


def contenders(pair: Pair) -> Contenders:
    def nodes(_bench: Bench, _size: Size) -> List[Contender]:
        ours = node("robot_vision", "filter_node", "filter", IMAGE, f"_chain:={pair.chain}")
        theirs = node("opencv_apps", pair.kind, "opencv_apps", IMAGE, "_debug_view:=false")
        return [
            Contender(
                f"filter_node {pair.chain}",
                [ours + settings(pair.ours)],
                "/filter/processed_image",
            ),
            Contender(
                f"opencv_apps {pair.kind}", [theirs + settings(pair.theirs)], "/opencv_apps/image"
            ),
        ]

    return nodes


def title(name: str) -> str:
    return f"Filter: {name}"


def targets() -> List[Target]:
    """What each chain may take beside its other, and all of them together."""
    each = [
        Target(title(name), SIZE, f"opencv_apps {pair.kind}", "cpu_ms", EACH)
        for name, pair in PAIRS.items()
    ]
    titles = tuple(target.title for target in each)
    return [*each, Target(ALL, SIZE, "opencv_apps", "cpu_ms", SUM, titles)]
