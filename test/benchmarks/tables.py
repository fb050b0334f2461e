"""The tables of the benchmarks, in Markdown."""

from typing import Any, Dict, Iterable, List, Sequence, Tuple

import numpy as np
from results import Accuracy, Comparison, Growth, Kernel, Machine, Parts, Size, Target

CLOCKS = ("cpu_ms", "wall_ms")
IN_PROCESS_LIMIT = 5.0  # %, what ROS may add to the kernels inside a process
SAME = 0.03  # part of a time by which that of the same call differs from one time to the next
BUSY = 0.05  # share of the processor that others may use before that is told
WORDS = {"cpu_ms": "CPU ms/frame", "median": "p50 ms", "arrived": "% of frames", "found": "% found"}
NOTHING = "roscpp, does nothing"
AT_LEAST = ("arrived", "found")


PARTS_TEXT = """Where the time of ours goes: what a roscpp node takes that does nothing but receive,
the work on pixels by itself, and all else.

"""
TRUTH_TEXT = """Against what is drawn, and so known, with the noise of simulated sensors; on one
thread. Tags of 0.12 m are 1 m away, in single images; the table is 1.1 m away. Motorcycle is a pair
of photographs whose disparities were measured.

"""
KERNELS_TEXT = """How many times as fast ours is on one thread; in brackets: ms of the other and of
ours. Both see the same frames in turns; medians, the least of all repetitions. Results that should
be equal are, to the bit. Beside memcpy 0.77 is the goal: at most 1.3 times as long.

"""


def table(columns: Sequence[str], rows: Iterable[Sequence[str]], texts: int = 1) -> str:
    """The first `texts` columns are to the left, the numbers after them to the right."""
    rule = "|" + "---|" * texts + "--:|" * (len(columns) - texts)
    lines = ["| {} |".format(" | ".join(cells)) for cells in (columns, *rows)]
    return "\n".join([lines[0], rule, *lines[1:]]) + "\n"


def ratio(ours: float, theirs: float) -> str:
    return f"{ours / theirs:.2f}"


def size_name(size: Size) -> str:
    return "{}x{}".format(*size)


def yes(reached: bool) -> str:
    return "yes" if reached else "**no**"


def machine_text(machine: Machine) -> str:
    lines = [f"- {line}" for line in machine.lines]
    share = f"{machine.others:.0%} of the processors' time went to other work"
    if machine.others > BUSY:
        share = f"**The machine was busy: {share}.** Figures are worse than they would be"
    return "\n".join([*lines, f"- {share}; load average at the start {machine.load:.1f}"]) + "\n"


def targets_table(targets: Sequence[Target], comparisons: Sequence[Comparison]) -> str:
    """A line for each target; those that nobody measured say so."""
    columns = ("work", "image", "beside", "figure", "theirs", "ours", "ratio", "goal", "reached")
    return table(columns, [target_row(target, comparisons) for target in targets], texts=4)


def compared(target: Target, comparisons: Sequence[Comparison]) -> List[Comparison]:
    """What a target is about; nothing unless all of it was measured."""
    by_title = {
        each.title: each
        for each in comparisons
        if each.size == target.size and any(name.startswith(target.against) for name in each.names)
    }
    titles = target.titles or (target.title,)
    return [by_title[title] for title in titles] if by_title.keys() >= set(titles) else []


def figures_of(target: Target, comparison: Comparison) -> Tuple[float, float]:
    """The target's figure: theirs, and ours."""
    ours = getattr(comparison.figures[0], target.figure)
    if not target.against:
        return (100.0 if target.figure in AT_LEAST else 1.0), ours  # % of all, or ms
    names = enumerate(comparison.names)
    which = next(i for i, name in names if name.startswith(target.against))
    return getattr(comparison.figures[which], target.figure), ours


def target_row(target: Target, comparisons: Sequence[Comparison]) -> List[str]:
    cells = [target.title, size_name(target.size), target.against or "-", WORDS[target.figure]]
    figures = [figures_of(target, comparison) for comparison in compared(target, comparisons)]
    if not figures:
        return [*cells, *["-"] * 4, "not measured"]
    theirs, ours = map(sum, zip(*figures))
    sign = ">=" if target.figure in AT_LEAST else "<="
    goal = f"{sign} {target.limit:.2f}"
    reached = ours >= target.limit * theirs if sign == ">=" else ours <= target.limit * theirs
    number = f"{theirs:.2f}" if target.against else "-"
    relative = target.against or target.figure in AT_LEAST
    value = ratio(ours, theirs) if relative and theirs > 0.0 else "-"
    return [*cells, number, f"{ours:.2f}", value, goal, yes(reached)]


def parts_table(
    parts: Sequence[Parts], comparisons: Sequence[Comparison], kernels: Sequence[Kernel]
) -> str:
    """Where the time of our nodes goes: receiving as in the node that does nothing else, work."""
    ours = {(each.title, each.size): each.figures[0].cpu_ms for each in comparisons}
    receiving = {
        each.size: each.figures[each.names.index(NOTHING)].cpu_ms
        for each in comparisons
        if NOTHING in each.names
    }
    work = {(kernel.work, kernel.size): kernel.ours_ms for kernel in kernels}
    rows = []
    for part in parts:
        names = ((ours, (part.title, part.size)), (receiving, part.size))
        known = [times.get(key) for times, key in (*names, (work, (part.work, part.size)))]
        if None not in known:
            known.append(known[0] - known[1] - known[2])
        cells = [f"{ms:.2f}" if ms is not None else "-" for ms in known]
        rows.append([part.title, size_name(part.size), *cells, *["-"] * (4 - len(cells))])
    columns = ("work", "image", "CPU ms/frame", "receiving", "on pixels", "all else")
    return table(columns, rows, texts=2)


def is_reached(kernel: Kernel) -> bool:
    """What is not to be slower may be the very same call, whose time differs from itself."""
    return kernel.times >= kernel.goal * (1.0 - SAME if kernel.goal == 1.0 else 1.0)


def kernels_table(kernels: Sequence[Kernel]) -> str:
    """A line for each work; how many times as fast ours is, and ms of theirs and ours."""
    sizes = sorted({kernel.size for kernel in kernels})
    works: Dict[Tuple[str, str], Dict[Size, Kernel]] = {}
    for kernel in kernels:
        works.setdefault((kernel.work, kernel.against), {})[kernel.size] = kernel
    rows = []
    for (work, against), by_size in works.items():
        goal = next(iter(by_size.values())).goal
        cells = [times_cell(by_size[size]) if size in by_size else "-" for size in sizes]
        reached = all(map(is_reached, by_size.values()))
        rows.append([work, against, *cells, f"{goal:.2g}", yes(reached)])
    return table(["work", "beside", *map(size_name, sizes), "goal", "reached"], rows, texts=2)


def times_cell(kernel: Kernel) -> str:
    times = f"{kernel.times:.2f}" if kernel.times < 100.0 else "> 100"
    return f"**{times}** ({kernel.theirs_ms:.3g} / {kernel.ours_ms:.3g})"


def sets_table(kernels: Sequence[Kernel]) -> str:
    """A line for each work, with a column for each instruction set."""
    names = list(dict.fromkeys(kernel.instructions for kernel in kernels))
    works: Dict[Tuple[str, str], Dict[str, Kernel]] = {}
    for kernel in kernels:
        works.setdefault((kernel.work, kernel.against), {})[kernel.instructions] = kernel
    rows = [
        [*work, *(times_cell(by_name[name]) if name in by_name else "-" for name in names)]
        for work, by_name in works.items()
    ]
    return table(["work", "beside", *names], rows, texts=2)


def growths_table(growths: Sequence[Growth]) -> str:
    """CPU ms of a frame, and of one more of what there is more and more of, by least squares."""
    rows = [
        [
            growth.title,
            growth.of,
            ", ".join(f"{x:g}: {ms:.3g}" for x, ms in zip(growth.numbers, growth.cpu_ms)),
            f"{np.polyfit(growth.numbers, growth.cpu_ms, 1)[0]:.3g}",
        ]
        for growth in growths
    ]
    return table(["work", "of", "CPU ms/frame by number", "one more"], rows, texts=3)


def accuracies_table(accuracies: Sequence[Accuracy]) -> str:
    """A line for each figure, with its limits as the goal."""
    rows = []
    for one in accuracies:
        least = [] if one.least is None else [f">= {one.least:.3g}"]
        most = [] if one.most is None else [f"<= {one.most:.3g}"]
        reached = (one.least is None or one.value >= one.least) and (
            one.most is None or one.value <= one.most
        )
        goal = ", ".join(least + most)
        cells = [one.work, one.of, one.figure, f"{one.value:.2f}", goal or "-"]
        rows.append([*cells, yes(reached) if goal else "-"])
    return table(["work", "of", "figure", "ours", "goal", "reached"], rows, texts=3)


def comparison_table(comparison: Comparison) -> str:
    """One row per contender; the ratios are those of the first to each."""
    columns = ("", "CPU ms/frame", "ratio", "% of a core", "p50 ms", "ratio", "p99 ms", "ratio")
    first = comparison.figures[0]
    rows = []
    for name, row in zip(comparison.names, comparison.figures):
        cells = [name, f"{row.cpu_ms:.2f}", ratio(first.cpu_ms, row.cpu_ms), f"{row.core:.1f}"]
        cells += [f"{row.median:.2f}", ratio(first.median, row.median)]
        cells += [f"{row.p99:.2f}", ratio(first.p99, row.p99), f"{row.arrived:.0f} %"]
        rows.append(cells)
    text = f"### {comparison.title}, {size_name(comparison.size)}\n\n"
    text += table((*columns, "frames"), rows)
    for figure, words in (
        ("same", "Pixels as expected"),
        ("found", "Frames in which all is found"),
    ):
        values = [
            f"{name} {getattr(row, figure):.2f} %"
            for name, row in zip(comparison.names, comparison.figures)
            if getattr(row, figure) >= 0
        ]
        if values:
            text += "\n{}: {}.\n".format(words, ", ".join(values))
    return text


def in_process_table(results: Sequence[Tuple[Size, Dict[str, Any]]]) -> str:
    columns = ["image", "OpenCV threads", "CPU: OpenCV", "core", "nodelet", "added"]
    columns += ["wall: OpenCV", "core", "nodelet", "added"]
    rows = []
    for size, result in results:
        cells = [size_name(size), str(result["threads"])]
        for clock in CLOCKS:
            times = [result[work][clock] for work in ("opencv", "core", "nodelet")]
            cells += [f"{time:.3f}" for time in times]
            cells.append(f"{(times[2] / times[0] - 1.0) * 1e2:+.1f} %")
        rows.append(cells)
    return (
        "### In one process: what the nodelet adds to the bare chain\n\n"
        f"At most {IN_PROCESS_LIMIT:.0f} % are allowed. Medians, in ms per frame.\n\n"
    ) + table(columns, rows)


def tags_table(results: Sequence[Tuple[Size, Dict[str, Any]]]) -> str:
    columns = ["image", "tags", "CPU: library", "ours", "ratio", "measuring", "ratio"]
    columns += ["p50: library", "ours", "ratio", "measuring", "ratio"]
    columns += ["p99: library", "ours", "worst: library", "ours", "found: library", "ours"]
    columns += ["longest: library", "ours", "corners: CPU", "library", "measured"]
    rows = []
    for size, result in results:
        plain, ours, measuring = (result[side] for side in ("plain", "ours", "measuring"))
        cells = [size_name(size), str(result["tags"])]
        for figure in ("cpu", "median"):
            cells += [f"{side[figure]:.2f}" for side in (plain, ours)]
            cells += [ratio(ours[figure], plain[figure]), f"{measuring[figure]:.2f}"]
            cells.append(ratio(measuring[figure], plain[figure]))
        for figure in ("p99", "worst"):
            cells += [f"{side[figure]:.1f}" for side in (plain, ours)]
        cells += [str(side["found"]) for side in (plain, ours)]
        cells += [f"{side['longest']:.2f}" for side in (plain, ours)]
        corners = result["corners"]
        cells += [f"{corners['cpu']:.3f}", f"{plain['error']:.3f}", f"{corners['error']:.3f}"]
        rows.append(cells)
    return (
        "### Tags: our detector, and libapriltag called for each frame\n\n"
        "Moving tags of tag36h11, at 30 Hz. The library: full resolution, 2 threads.\n"
        "In ms per frame; longest: that a tag of the image was not found, in s.\n"
        "Measuring: ours with measured corners, the node's default; all else is without.\n"
        "Corners measured for poses: CPU in ms per tag, and the median errors in px.\n\n"
    ) + table(columns, rows)


def tag_depth_table(results: Sequence[Dict[str, Any]]) -> str:
    """A line for each tag and noise of its corners; three columns for each figure."""
    ways = ("points", "corners", "both")
    figures = {"tilt": "{:.2f}", "distance": "{:.1f}", "wrong": "{:.1%}", "us": "{:.0f}"}
    columns = ["tag, distance, tilt, corners"]
    for figure in ("tilt", "distance", "wrong side", "us"):
        columns += [f"{figure}: points", "corners", "both"]
    rows = [
        [
            "{size:g} m, {distance:g} m, {tilt:g}°, {noise:g} px".format(**result),
            *(text.format(result[way][name]) for name, text in figures.items() for way in ways),
        ]
        for result in results
    ]
    return (
        "### Tags and a Kinect: poses by points, by corners, and by both\n\n"
        "Points: as ar_track_alvar documents it, centroid and plane of the points inside of the\n"
        "tag, axes of those of its four corners. Root mean square errors of the tilt in degrees\n"
        "and of the distance in mm; wrong side: tilted to the other side, or no pose at all. µs\n"
        "of CPU for a pose, median. Corners with 0.3 px are as libapriltag finds them, with 0.03\n"
        "px as they are measured.\n\n"
    ) + table(columns, rows)


def vm_table(figures: Dict[str, float]) -> str:
    others = [name for name in figures if not name.startswith("camera_node")]
    rows = [
        [name, f"{seconds * 1e3:.2f}", *(ratio(seconds, figures[other]) for other in others)]
        for name, seconds in figures.items()
    ]
    return (
        "### A V4L2 camera in a VM (emulated), YUYV 640x480 at 25 Hz\n\n"
        "CPU ms per frame; camera_node also sends each to a subscriber over TCP.\n\n"
    ) + table(["", "CPU", *(f"ratio to {name}" for name in others)], rows)


def report(
    machine: Machine,
    beaten: str,
    where: str,
    sections: Dict[str, List[str]],
    plot: str,
    notes: str,
) -> str:
    """All of BENCHMARKS.md: tables of targets and of parts, sections by title, plot, notes."""
    texts = ["# Benchmarks\n", machine_text(machine), "## Figures to beat\n", beaten]
    texts.append(PARTS_TEXT + where)
    for title, tables in sections.items():
        texts += [f"## {title}\n", *tables]
    return "\n".join([*texts, f"![CPU time of a frame]({plot})\n", notes])
