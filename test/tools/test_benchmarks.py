"""The tables of test/benchmarks: given results, BENCHMARKS.md says what they are."""

import re

import cv2
import depth_truth
import filter_contenders
import nano_network
import numpy as np
import plain_network
import plot
import pytest
import receiving_figures
import skimage.data
import stereo_contenders
import tables
import yaml
from receiving_figures import MANY, Costs, Receiving
from results import (
    Accuracy,
    Comparison,
    Figures,
    Growth,
    Kernel,
    Machine,
    Parts,
    Target,
    to_kernels,
)

import robot_vision as rv
from robot_vision.dnn.cost import flop_of
from robot_vision.dnn.model_file import read_model
from robot_vision.dnn.network_input import input_of
from robot_vision.dnn.opencv_runtime import OpenCvRuntime

SMALL, LARGE = (640, 480), (1920, 1080)


def figures(cpu_ms, median=1.0, arrived=100.0, found=-1.0):
    return Figures(cpu_ms, cpu_ms * 3, median, 2 * median, arrived, -1.0, found)


def kernel(work="edges", size=LARGE, theirs_ms=9.0, ours_ms=3.0, goal=3.0, instructions="avx2"):
    return Kernel(work, "Canny", size, instructions, 1, theirs_ms, ours_ms, goal)


def cells(text, word):
    """Of the only line of a table with this word."""
    (line,) = (line for line in text.splitlines() if line.startswith("|") and word in line)
    return [cell.strip() for cell in line.strip("|").split("|")]


@pytest.mark.parametrize(
    "target, expected",
    [
        (
            Target("Edges", LARGE, "other", "cpu_ms", 1 / 2),
            ["8.00", "2.00", "0.25", "<= 0.50", "yes"],
        ),
        (
            Target("Edges", LARGE, "other", "cpu_ms", 1 / 5),
            ["8.00", "2.00", "0.25", "<= 0.20", "**no**"],
        ),
        (
            Target("Edges", LARGE, "other", "median", 1.0),
            ["3.00", "4.00", "1.33", "<= 1.00", "**no**"],
        ),
        (
            Target("Edges", LARGE, "other", "found", 1.0),
            ["90.00", "95.00", "1.06", ">= 1.00", "yes"],
        ),
        (Target("Edges", LARGE, "", "arrived", 0.98), ["-", "97.00", "0.97", ">= 0.98", "**no**"]),
        (Target("Edges", LARGE, "", "median", 5.0), ["-", "4.00", "-", "<= 5.00", "yes"]),
        (Target("Edges", LARGE, "", "median", 3.9), ["-", "4.00", "-", "<= 3.90", "**no**"]),
        (Target("Edges", SMALL, "other", "cpu_ms", 1.0), ["-", "-", "-", "-", "not measured"]),
        (Target("Edges", LARGE, "absent", "cpu_ms", 1.0), ["-", "-", "-", "-", "not measured"]),
    ],
)
def test_a_target_is_reached_or_not(target, expected):
    rows = [figures(2.0, 4.0, arrived=97.0, found=95.0), figures(8.0, 3.0, found=90.0)]
    text = tables.targets_table([target], [Comparison("Edges", LARGE, ["ours", "other"], rows)])
    assert cells(text, "Edges")[4:] == expected


@pytest.mark.parametrize("limit, reached", [(0.5, "yes"), (0.4, "**no**")])
def test_figures_of_several_comparisons_are_added_up(limit, reached):
    target = Target("All", LARGE, "other", "cpu_ms", limit, ("Box", "Median"))
    box = Comparison("Box", LARGE, ["ours", "other box"], [figures(3.0), figures(4.0)])
    median = Comparison("Median", LARGE, ["ours", "other one"], [figures(1.5), figures(6.0)])
    alone = tables.targets_table([target], [box])  # would be reached without what is not measured
    assert cells(alone, "All")[4:] == ["-", "-", "-", "-", "not measured"]
    text = tables.targets_table([target], [box, median])
    assert cells(text, "All")[4:] == ["10.00", "4.50", "0.45", f"<= {limit:.2f}", reached]


@pytest.mark.parametrize("name", filter_contenders.PAIRS)
def test_the_chains_that_are_measured_are_those_of_the_node(name):
    pair = filter_contenders.PAIRS[name]
    words = (word.split(":=") for word in pair.ours.split() if ":=/" not in word)
    values = {key: yaml.safe_load(value) for key, value in words if key != "use_second"}
    assert values
    rv.FilterChain(pair.chain.split(","), values)  # refuses names and values that it has not


def test_the_matcher_that_is_measured_has_parameters_that_there_are():
    params = rv.StereoParams()
    for word in stereo_contenders.SAME:
        name, value = word.split(":=")
        assert hasattr(params, name), name
        setattr(params, name, yaml.safe_load(value))
    rv.validate(params)
    assert params != rv.StereoParams()


def test_the_network_that_is_measured_is_nano_and_finds_things_that_overlap(tmp_path):
    model = read_model(str(nano_network.nano_file(tmp_path)))
    network_input = input_of(model)
    assert (network_input.width, network_input.height) == (416, 416)
    runtime = OpenCvRuntime(model, network_input)
    assert flop_of(model, network_input, runtime)[0] == pytest.approx(1.056e9, rel=1e-3)
    image = cv2.cvtColor(skimage.data.astronaut(), cv2.COLOR_RGB2BGR)
    detector = plain_network.PlainDetector("opencv", model.path, 1, 416)
    (output,) = runtime.run(detector.input_of(image)[0])
    assert output.shape == (1, 84, 3549)
    likely = np.count_nonzero(output[0, 4:].max(axis=0) >= plain_network.SCORE)
    assert 10 <= 2 * len(detector.detect(image)) <= likely <= 300


def test_kernels_have_a_line_for_each_work_and_a_column_for_each_size():
    faster = kernel(theirs_ms=9.0, ours_ms=3.0)
    slower = kernel(size=SMALL, theirs_ms=2.95, ours_ms=1.0)
    others = kernel("gray", ours_ms=1.0, theirs_ms=0.98, goal=1.0)  # as near as the same call is
    text = tables.kernels_table([faster, slower, others])
    assert cells(text, "work") == ["work", "beside", "640x480", "1920x1080", "goal", "reached"]
    expected = ["edges", "Canny", "**2.95** (2.95 / 1)", "**3.00** (9 / 3)", "3", "**no**"]
    assert cells(text, "edges") == expected
    assert cells(text, "gray") == ["gray", "Canny", "-", "**0.98** (0.98 / 1)", "1", "yes"]
    slower = tables.kernels_table([kernel("gray", ours_ms=1.0, theirs_ms=0.96, goal=1.0)])
    assert cells(slower, "gray")[-1] == "**no**"


def test_instruction_sets_have_a_column_each():
    text = tables.sets_table([kernel(), kernel(instructions="baseline", theirs_ms=3.0)])
    assert cells(text, "work") == ["work", "beside", "avx2", "baseline"]
    assert cells(text, "edges")[2:] == ["**3.00** (9 / 3)", "**1.00** (3 / 3)"]


def test_growth_tells_what_one_more_costs():
    growth = Growth("faces", "number", [0, 1, 4], [1.0, 3.0, 9.0])
    assert cells(tables.growths_table([growth]), "faces")[2:] == ["0: 1, 1: 3, 4: 9", "2"]


def test_where_the_time_of_a_node_goes():
    comparisons = [
        Comparison("Edges", LARGE, ["ours"], [figures(9.0)]),
        Comparison("Receiving", LARGE, ["ours", tables.NOTHING], [figures(2.5), figures(2.0)]),
    ]
    parts = [Parts("Edges", LARGE, "edges"), Parts("Edges", LARGE, "unknown work")]
    text = tables.parts_table(parts, comparisons, [kernel(ours_ms=3.0)])
    assert "| Edges | 1920x1080 | 9.00 | 2.00 | 3.00 | 4.00 |" in text
    assert "| Edges | 1920x1080 | 9.00 | 2.00 | - | - |" in text


def test_a_comparison_has_the_ratios_of_the_first():
    rows = [figures(2.0, 4.0, found=95.0), figures(8.0, 5.0, found=90.0)]
    text = tables.comparison_table(Comparison("Edges", LARGE, ["ours", "other"], rows))
    assert text.startswith("### Edges, 1920x1080\n")
    expected = ["other", "8.00", "0.25", "24.0", "5.00", "0.80", "10.00", "0.80", "100 %"]
    assert cells(text, "| other") == expected
    assert "Frames in which all is found: ours 95.00 %, other 90.00 %." in text


@pytest.mark.parametrize("others, busy", [(0.04, False), (0.5, True)])
def test_a_busy_machine_is_told(others, busy):
    text = tables.machine_text(Machine(["2 cores"], load=1.5, others=others))
    assert "- 2 cores\n" in text
    assert f"{others:.0%} of the processors' time went to other work" in text
    assert ("The machine was busy" in text) == busy


def test_the_report_has_all_parts_in_their_order():
    machine = Machine(["2 cores"], load=1.5, others=0.0)
    sections = {"Kernels": ["| one |\n", "| two |\n"], "Growth": ["| three |\n"]}
    text = tables.report(
        machine, "| beaten |\n", "| where |\n", sections, "docs/plot.svg", "## Notes\n"
    )
    order = ["# Benchmarks", "- 2 cores", "## Figures to beat", "| beaten |", "| where |"]
    order += [
        "## Kernels",
        "| one |",
        "| two |",
        "## Growth",
        "| three |",
        "![CPU time of a frame](docs/plot.svg)",
        "## Notes",
    ]
    assert [line for line in text.splitlines() if line in order] == order


def run_of(name, theirs_ms, ours_ms, **more):
    times = {"theirs_ms": theirs_ms, "ours_ms": ours_ms, "goal": 3.0}
    return {
        "name": name,
        "run_name": name,
        "run_type": "iteration",
        "label": "Canny",
        **times,
        **more,
    }


def test_of_repetitions_the_least_counts():
    name = "edges of bgr8/1920x1080/avx2/2/manual_time"
    runs = [
        run_of(name, 9.0, 4.0),
        run_of(name, 10.0, 3.0),
        run_of(name, 1.0, 1.0, run_type="aggregate"),
    ]
    expected = Kernel("edges of bgr8", "Canny", LARGE, "avx2", 2, 9.0, 3.0, 3.0)
    assert to_kernels(runs) == [expected]


def test_results_that_differ_are_an_error():
    failed = run_of(
        "edges/1x1/avx2/1/manual_time", 1.0, 1.0, error_occurred=True, error_message="differ"
    )
    with pytest.raises(RuntimeError, match="edges/1x1/avx2/1/manual_time: differ"):
        to_kernels([failed])


def test_the_plot_is_small_and_the_same_for_the_same_numbers():
    growths = [Growth(f"work {i}", f"number {i % 6}", [0, 1, 4], [1.0, 3.0, 9.0]) for i in range(9)]
    svg = plot.draw(growths)
    assert svg == plot.draw(growths)
    assert len(svg) < 60_000
    for i in range(9):
        assert f">work {i}</text>" in svg


def test_poses_by_depth_have_a_line_for_each_tag():
    figures = {"tilt": 1.234, "distance": 5.67, "wrong": 0.012, "us": 89.6}
    of = {"size": 0.1, "distance": 2.0, "tilt": 40.0, "noise": 0.03}
    result = {**of, "points": figures, "corners": figures, "both": {**figures, "tilt": 0.5}}
    text = tables.tag_depth_table([result])
    found = cells(text, "0.1 m, 2 m, 40°, 0.03 px")[1:]
    assert found == ["1.23", "1.23", "0.50", *["5.7"] * 3, *["1.2%"] * 3, *["90"] * 3]
    assert len(cells(text, "corners | both")) == len(found) + 1


@pytest.mark.parametrize(
    "value, least, most, goal, reached",
    [
        (0.4, None, 0.5, "<= 0.5", "yes"),
        (0.504, None, 0.5, "<= 0.5", "**no**"),
        (98.7, 99.0, None, ">= 99", "**no**"),
        (0.9, 0.8, 1.2, ">= 0.8, <= 1.2", "yes"),
        (1.3, 0.8, 1.2, ">= 0.8, <= 1.2", "**no**"),
        (7.0, None, None, "-", "-"),
    ],
)
def test_a_figure_of_ours_alone_has_limits(value, least, most, goal, reached):
    text = tables.accuracies_table([Accuracy("tags", "kinect", "ratio", value, least, most)])
    assert cells(text, "tags") == ["tags", "kinect", "ratio", f"{value:.2f}", goal, reached]


@pytest.mark.parametrize("part", ["tables", "tags", "small_tags"])
def test_depth_is_measured_for_each_sensor(part):
    found = list(getattr(depth_truth, part)(2))
    assert [re.split("[,;]", one.of)[0] for one in found] == [
        sensor for sensor in depth_truth.SENSORS for _ in range(len(found) // 3)
    ]
    assert all(one.least or one.most for one in found)


def test_what_receiving_costs_is_what_frames_cost_beyond_idle_processes():
    of_frame = receiving_figures.above(Costs(0.09, 0.06, 2.0, 30.0), Costs(0.03, 0.03, 0.0, 0.0))
    assert of_frame == pytest.approx((2.0, 1.0, 2.0, 30.0))
    figures = {
        size: {
            ("raw", 1): Receiving(3.0, 2.0, 5.0, 30.0),
            ("raw", MANY): Receiving(9.0, 2.0, 9.0, 25.0),
            ("shm", 1): Receiving(1.0, of_each, 0.9, 30.0),
            ("shm", MANY): Receiving(1.3, 1.0, 1.0, 30.0),
        }
        for size, of_each in zip(receiving_figures.SIZES, (0.08, 0.1, 0.12))
    }
    text = receiving_figures.costs_table(figures)
    row = ["3.00", "1.00", "2.000", "0.100", "5.00", "0.90", "30.0", "30.0"]
    assert cells(text, "1920x1080, 1 ") == ["1920x1080, 1", *row]
    reached = cells(tables.accuracies_table(receiving_figures.goals(figures)), "p50 ms")
    assert reached[-3:] == ["0.90", "<= 1", "yes"]
    values = [goal.value for goal in receiving_figures.goals(figures)]
    assert values == pytest.approx([0.1, 0.9, 1.5, 1.3, 10.0])
