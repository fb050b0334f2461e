"""Draws the growths: a curve of CPU time for each, those of one kind in one diagram."""

import io
import re
from typing import Dict, List, Sequence

import matplotlib
from results import Growth

matplotlib.use("svg")
matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "robot_vision", "font.size": 8})


def draw(growths: Sequence[Growth]) -> str:
    """An SVG, the same for the same numbers."""
    from matplotlib import pyplot

    kinds: Dict[str, List[Growth]] = {}
    for growth in growths:
        kinds.setdefault(growth.of, []).append(growth)
    columns = 3
    rows = -(-len(kinds) // columns)
    figure, axes = pyplot.subplots(rows, columns, figsize=(9, 2.6 * rows), squeeze=False)
    for axis in axes.flat[len(kinds) :]:
        axis.set_visible(False)
    for axis, (kind, curves) in zip(axes.flat, kinds.items()):
        for curve in curves:
            label = curve.title.partition(" (")[0]
            axis.plot(curve.numbers, curve.cpu_ms, marker="o", markersize=3, label=label)
        axis.locator_params(nbins=4)
        axis.set(xlabel=kind, ylabel="CPU ms/frame", ylim=(0, None))
        axis.legend(fontsize=6)
    figure.tight_layout()
    svg = io.StringIO()
    figure.savefig(svg, format="svg", metadata={"Date": None})
    pyplot.close(figure)
    short = re.sub(r"(\d\.\d\d)\d+", r"\1", svg.getvalue())  # a hundredth of a point is fine enough
    return "".join(line.strip() + "\n" for line in short.splitlines())
