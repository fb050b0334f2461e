"""What was recognized, as tables and as figures with their goals."""

import statistics
from pathlib import Path
from typing import Any, Dict, List, Sequence

from results import Accuracy
from tables import table

OCCLUSIONS = (0, 20, 40, 60)  # %
TEXT = """Sample meshes on a table among other things, drawn with the noise of a Kinect and of
stereo: {scenes} frames of each of {objects} objects, a third of them without it; the same
for all, on one thread. Found: the mean distance of the points (ADD, or ADD-S with
symmetries) is below a tenth of the diameter: a mug whose handle nobody can see counts as
wrong if its handle is elsewhere. "As seen" counts that, too: of what is seen of the object
in the pose found or in the true one, at least 90 % has the other's color and is within a
twentieth of the diameter of its surface (after BOP's visible surface discrepancy). False:
of a frame without the object; wrong, by the first of these measures: of all frames. What
refines and verifies is told which of the two sensors it is. cv::linemod has the views and
thresholds of object_recognition_core, and the ICP of cv::ppf_match_3d. Errors are medians of
what was found.

"""
MODELS = Path("/usr/share/assimp/models")  # of Debian's package assimp-testmodels
MODELS_TEXT = """### Meshes by others

The same with {objects} models of Debian's package assimp-testmodels, each made 0.2 m large, among
the others: a duck, a boar and a monkey without colors, and an engine, a truck and a spider with
colors. {scenes} frames of each. Nothing was fitted to them. The legs of the spider are thinner
than what a depth sensor sees.

"""


def contender_names(objects: Sequence[Dict[str, Any]]) -> List[str]:
    return [name for name, value in objects[0].items() if isinstance(value, dict)]


def mean_recalls(
    objects: Sequence[Dict[str, Any]], name: str, figure: str = "recall"
) -> List[float]:
    """%, over all objects, by occlusion; `figure` is "recall" or "recall_as_seen"."""
    return [100 * statistics.mean(column) for column in zip(*(o[name][figure] for o in objects))]


def middle(objects: Sequence[Dict[str, Any]], name: str, figure: str) -> float:
    """The median over the objects; of errors, over those that were found."""
    values = [one[name][figure] for one in objects if one[name][figure] >= 0.0]
    return statistics.median(values) if values else -1.0


def mean(objects: Sequence[Dict[str, Any]], name: str, figure: str) -> float:
    return statistics.mean(one[name][figure] for one in objects)


def contenders_table(objects: Sequence[Dict[str, Any]], scenes: int, text: str = TEXT) -> str:
    columns = [
        "",
        *(f"% found (as seen), {share} % hidden" for share in OCCLUSIONS),
        "false",
        "wrong",
    ]
    columns += ["mm", "degrees", "CPU ms: match", "decide", "s to train"]
    rows = []
    for name in contender_names(objects):
        recalls = mean_recalls(objects, name)
        as_seen = mean_recalls(objects, name, "recall_as_seen")
        cells = [name, *(f"{share:.1f} ({seen:.1f})" for share, seen in zip(recalls, as_seen))]
        cells += [f"{mean(objects, name, figure):.3f}" for figure in ("false", "wrong")]
        for figure in ("mm", "deg", "match_ms", "decide_ms"):
            value = middle(objects, name, figure)
            cells.append(f"{value:.2f}" if value >= 0.0 else "-")
        train = statistics.median(one[f"train {name}"] for one in objects)
        rows.append([*cells, f"{train:.2f}"])
    return text.format(scenes=scenes, objects=len(objects)) + table(columns, rows)


def growth_table(grown: Dict[str, Any]) -> str:
    """Of the views alone; the templates are those of one object."""
    columns = ("by views, of", "number", "CPU ms: match", "decide", "s to train", "MB")
    rows = [
        [
            of,
            str(one["number"]),
            f"{one['match_ms']:.1f}",
            f"{one['decide_ms']:.1f}",
            f"{one['train']:.2f}",
            f"{one['memory']:.2f}",
        ]
        for of in ("objects", "templates")
        for one in grown[of]
    ]
    return "### By the number of objects and of templates\n\n" + table(columns, rows)


def goals(objects: Sequence[Dict[str, Any]], grown: Dict[str, Any]) -> List[Accuracy]:
    """What is to be reached, and what was."""
    recalls = mean_recalls(objects, "views")
    as_seen = mean_recalls(objects, "views", "recall_as_seen")
    fifteen = next(one for one in grown["objects"] if one["number"] == 15)
    full = next(one for one in grown["templates"] if one["number"] > 5000)
    figures = [
        ("views", "% found, nothing hidden", recalls[0], 97.0, None),
        ("views", "% found, nothing hidden, as seen", as_seen[0], 97.0, None),
        ("views", "% found, 40 % hidden", recalls[2], 85.0, None),
        ("views", "% found, 40 % hidden, as seen", as_seen[2], 85.0, None),
        ("views", "false objects in a frame", mean(objects, "views", "false"), None, 0.02),
        ("views", "mm, median", middle(objects, "views", "mm"), None, 1.5),
        ("views", "degrees, median", middle(objects, "views", "deg"), None, 1.5),
        ("views", f"ms to match {full['number']} templates", full["match_ms"], None, 20.0),
        ("views", "ms for 15 objects", fifteen["match_ms"] + fifteen["decide_ms"], None, 100.0),
        ("views", f"s to train {full['number']} templates", full["train"], None, 5.0),
        ("point pairs", "s to train", grown["pairs_train"], None, 2.0),
        ("point pairs", "ms to match", middle(objects, "point pairs", "match_ms"), None, 150.0),
    ]
    return [Accuracy("objects recognized", *figure) for figure in figures]
