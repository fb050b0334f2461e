"""Layouts of bundles that are learnt from noisy frames, and the files of bundles."""

import numpy as np
import pytest
import yaml
from tags import (
    CAMERA,
    CAMERAS,
    corners_of,
    error_of,
    matrix,
    pose_in_view,
    squared_error,
    turn_of,
    turned,
    visible,
)

import robot_vision as rv
from robot_vision.tags.bundle_calibration import calibrate
from robot_vision.tags.bundle_files import parse_bundles, write_bundles

SIDE = 0.1  # m
MASTER = 10
NOISE = 0.2  # px


def random_layout(rng, count, flat):
    layout = {MASTER: np.eye(4)}
    for tag in range(MASTER + 1, MASTER + count):
        spin = turned([0, 0, rng.uniform(-3, 3)])
        turn = spin if flat else turned(rng.uniform(-0.5, 0.5, 3)) @ spin
        place = rng.uniform(-0.35, 0.35, 3) * ([1, 1, 0] if flat else [1, 1, 0.5])
        layout[tag] = matrix(turn, place)
    return layout


def frames_of(rng, layout, count, only=None, noise=NOISE, camera=CAMERA):
    """Frames of corners by tag, from about 1 m away and many sides; only(frame) chooses tags."""
    frames = []
    while len(frames) < count:
        body = pose_in_view(rng, rng.uniform(90, 170), rng.uniform(0, 1.1))
        tags = layout if only is None else only(len(frames))
        places = {tag: layout[tag] for tag in tags}
        frames.append(
            {
                tag: corners + rng.normal(0.0, noise, (4, 2))
                for tag, corners in visible(body, places, camera, SIDE).items()
            }
        )
    return frames


def learnt(frames, layout, camera=CAMERA, side=SIDE):
    """What is learnt of a layout whose tags have sides of `side` m."""
    return calibrate("box", frames, {tag: side for tag in layout}, camera, MASTER)


def worst(bundle, layout):
    """The largest errors of a bundle's tags in m and degrees."""
    errors = [error_of(tag.pose, layout[tag.id]) for tag in bundle.tags]
    return (
        max(np.linalg.norm(error[:3]) for error in errors),
        max(map(turn_of, errors)),
    )


@pytest.mark.parametrize("model", CAMERAS)
@pytest.mark.parametrize("flat", [False, True], ids=["solid", "flat"])
def test_a_random_layout_is_recovered(model, flat):
    rng = np.random.default_rng(11)
    layout = random_layout(rng, 8, flat)
    frames = frames_of(rng, layout, 300, camera=CAMERAS[model])
    before = [{tag: corners.copy() for tag, corners in frame.items()} for frame in frames]
    found = learnt(frames, layout, CAMERAS[model])
    shift, turn = worst(found.bundle, layout)
    assert shift < 0.0005 and turn < 0.2
    assert found.bundle.name == "box" and found.bundle.tags[0].id == MASTER
    assert np.array_equal(found.bundle.tags[0].pose, np.eye(4))
    assert sorted(found.residuals) == sorted(layout)
    for residual in found.residuals.values():
        assert residual == pytest.approx(NOISE * np.sqrt(2), rel=0.15)
    assert found.frames == sum(len(frame) > 1 for frame in frames)
    assert found.rejected == 0
    assert found.observations == {
        tag: sum(tag in frame for frame in frames if len(frame) > 1) for tag in layout
    }
    for frame, old in zip(frames, before):
        assert all(np.array_equal(frame[tag], old[tag]) for tag in old)


def test_exact_corners_give_the_exact_layout():
    rng = np.random.default_rng(16)
    layout = random_layout(rng, 3, False)
    frames = frames_of(rng, layout, 10, noise=0.0, camera=CAMERAS["equidistant"])
    found = learnt(frames, layout, CAMERAS["equidistant"])
    shift, turn = worst(found.bundle, layout)
    assert shift < 1e-5 and turn < 1e-3 and found.rejected == 0


def fitting_frame(bundle, layout):
    """The pose of the frame in which a bundle fits a layout best."""
    places = 0.5 * SIDE * np.array([[-1, -1, 0, 1 / (0.5 * SIDE)], [1, -1, 0, 1 / (0.5 * SIDE)]])
    places = np.vstack([places, places * [-1, -1, 1, 1]])
    learnt = np.vstack([places @ tag.pose[:3].T for tag in bundle.tags])
    true = np.vstack([places @ layout[tag.id][:3].T for tag in bundle.tags])
    # Kabsch: A solution for the best rotation to relate two sets of vectors, 1976.
    u, _, vt = np.linalg.svd((learnt - learnt.mean(0)).T @ (true - true.mean(0)))
    turn = vt.T @ np.diag([1.0, 1.0, np.linalg.det(vt.T @ u.T)]) @ u.T
    return matrix(turn, true.mean(0) - turn @ learnt.mean(0))


def test_uncertainties_of_a_layout_are_right():
    """So are the poses of a bundle that was learnt from few images."""
    shifts, turns, squares = [], [], []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        layout = random_layout(rng, 5, seed % 2)
        frames = frames_of(rng, layout, 30, noise=0.4)
        bundle = learnt(frames, layout).bundle
        frame = fitting_frame(bundle, layout)
        for tag in bundle.tags:
            error = error_of(frame @ tag.pose, layout[tag.id])
            shifts.append(np.mean(error[:3] ** 2) / tag.shift_noise**2)
            turns.append(np.mean(error[3:] ** 2) / tag.turn_noise**2)
        for _ in range(10):
            body = pose_in_view(rng, 120, rng.uniform(0, 1))
            seen = {
                tag: rv.MeasuredCorners(corners + rng.normal(0.0, 0.02, (4, 2)), 0.0004 * np.eye(8))
                for tag, corners in visible(body, layout, CAMERA, SIDE).items()
            }
            if len(seen) > 1:
                best = rv.estimate_pose(bundle, seen, CAMERA, lens_noise=0.0).best
                squares.append(squared_error(best, body @ frame) / 6.0)
    assert len(squares) > 150
    for values in (shifts, turns, squares):
        assert 0.7 < np.mean(values) < 1.5


def test_tags_are_linked_by_others_while_the_master_is_out_of_view():
    """Only neighbours in a row are seen together, and some tags do not belong to the bundle."""
    rng = np.random.default_rng(12)
    layout = {MASTER + i: matrix(turned([0, -0.4 * i, 0]), [0.2 * i, 0, 0]) for i in range(4)}
    frames = frames_of(rng, layout, 200, lambda i: (MASTER + i % 3, MASTER + 1 + i % 3))
    for frame in frames:
        frame[99] = np.zeros((4, 2))
    sizes = {tag: SIDE for tag in layout}
    found = calibrate("row", frames, sizes, CAMERA, MASTER)
    shift, turn = worst(found.bundle, layout)
    assert shift < 0.001 and turn < 0.4
    # With another master tag it is the same body.
    other = calibrate("row", frames, sizes, CAMERA, MASTER + 2)
    inverse = np.linalg.inv(layout[MASTER + 2])
    shift, turn = worst(other.bundle, {tag: inverse @ pose for tag, pose in layout.items()})
    assert shift < 0.001 and turn < 0.4


def test_a_few_misplaced_tags_are_rejected():
    rng = np.random.default_rng(13)
    layout = random_layout(rng, 4, False)
    frames = frames_of(rng, layout, 120)
    for frame in frames[::20]:
        for tag in list(frame)[:1]:
            frame[tag] = frame[tag] + 40.0  # px, so that it does not fit the others
    found = learnt(frames, layout)
    shift, turn = worst(found.bundle, layout)
    assert shift < 0.0005 and turn < 0.2
    assert 6 <= found.rejected <= 18  # if two tags contradict each other, both are rejected
    # A layout of twice the size is twice as far away.
    double = learnt(frames, layout, side=2 * SIDE)
    for one, two in zip(found.bundle.tags, double.bundle.tags):
        assert np.allclose(2 * one.pose[:3, 3], two.pose[:3, 3], atol=2e-5)


def test_errors_of_learning_are_named():
    rng = np.random.default_rng(14)
    layout = random_layout(rng, 4, True)
    sizes = {tag: SIDE for tag in layout}
    frames = frames_of(rng, layout, 30)

    def refused(frames, sizes, master=MASTER):
        with pytest.raises(ValueError) as error:
            calibrate("box", frames, sizes, CAMERA, master)
        return str(error.value)

    assert "master tag 7 has no size" in refused(frames, sizes, 7)
    assert "tag 10 alone" in refused(frames, {10: SIDE})
    assert "tag 42 was not seen in any of 30 frames" in refused(frames, {**sizes, 42: SIDE})
    without = [{tag: c for tag, c in frame.items() if tag != MASTER} for frame in frames]
    assert "master tag 10 was not seen" in refused(without, sizes)
    pairs = frames_of(rng, layout, 30, lambda i: [(10, 11), (12, 13)][i % 2])
    assert "tags [12, 13] were never seen together with the master tag 10" in refused(pairs, sizes)
    alone = [{tag: frame[tag]} for frame in frames for tag in frame]
    assert "tags [11, 12, 13] were never seen together" in refused(alone, sizes)
    assert "size of tag 11" in refused(frames, {**sizes, 11: 0.0})
    assert "master tag 10 was not seen in any of 0 frames" in refused([], sizes)
    many = frames_of(rng, layout, 60)
    loose = [
        {tag: c for tag, c in frame.items() if tag != 13 or i < 9} for i, frame in enumerate(many)
    ]
    for frame in loose[:9]:
        if 13 in frame:
            frame[13] = frame[13] + rng.uniform(-100, 100, 2)
    assert "tags [13] are not on one rigid body" in refused(loose, sizes)
    index = next(i for i, frame in enumerate(frames) if i > 5 and len(frame) > 1)
    tag = next(iter(frames[index]))
    frames[index][tag] = np.full((4, 2), np.nan)
    assert f"frame {index}: corners of tag {tag}" in refused(frames, sizes)


def test_a_tag_without_a_link_to_others_is_named():
    rng = np.random.default_rng(15)
    layout = random_layout(rng, 4, True)
    frames = frames_of(rng, layout, 40, lambda i: [10, 11, 12] if i < 39 else [11, 13])
    frames[39] = {tag: corners_of(place, CAMERA, SIDE) for tag, place in both_in_view(layout)}
    # The tag that it was seen with is not a square, so it is ignored.
    frames[39][11] = frames[39][11] + [[6, 6], [-6, 6], [6, -6], [-6, -6]]
    with pytest.raises(ValueError, match=r"tags \[13\] were seen too little with others"):
        learnt(frames, layout)


def both_in_view(layout):
    middle = (layout[11][:3, 3] + layout[13][:3, 3]) / 2.0
    body = matrix(turned([np.pi + 0.3, 0, 0]), np.zeros(3))
    body[:3, 3] = [0.0, 0.0, 1.2] - body[:3, :3] @ middle
    return [(tag, body @ layout[tag]) for tag in (11, 13)]


def read_bundles(path):
    return parse_bundles(yaml.safe_load(path.read_text())["tag_bundles"])


def test_a_bundle_is_read_as_it_was_written(tmp_path):
    rng = np.random.default_rng(15)
    path = tmp_path / "bundles.yaml"
    path.write_text("an old file")
    bundles = [
        rv.Bundle(
            name,
            [
                rv.BundleTag(i, 0.1 + i / 7, pose, 0.0001 * i, 0.001 * i)
                for i, pose in random_layout(rng, 5, False).items()
            ],
        )
        for name in ("box", 'it\'s: a #1 "name"')
    ]
    write_bundles(str(path), bundles)
    assert [entry.name for entry in tmp_path.iterdir()] == ["bundles.yaml"]
    as_read = read_bundles(path)
    assert len(as_read) == len(bundles)
    for wrote, read in zip(bundles, as_read):
        assert wrote.name == read.name
        assert [tag.id for tag in wrote.tags] == [tag.id for tag in read.tags]
        for one, two in zip(wrote.tags, read.tags):
            assert one.size == two.size and np.allclose(one.pose, two.pose, atol=1e-6)
            assert one.shift_noise == pytest.approx(two.shift_noise, abs=1e-6)
            assert one.turn_noise == pytest.approx(two.turn_noise, abs=1e-5)


def test_files_of_apriltag_ros_are_read():
    """Names are optional in these files, and so are the parts of a pose that are 0."""
    bundles = parse_bundles(
        [
            {"layout": [{"id": 3, "size": 0.2}]},
            {
                "name": "b",
                "layout": [{"id": 4, "size": 1, "x": 1, "z": -0.5, "qw": 0.0, "qz": 1.0}],
            },
        ]
    )
    assert [bundle.name for bundle in bundles] == ["bundle_0", "b"]
    assert np.array_equal(bundles[0].tags[0].pose, np.eye(4))
    (tag,) = bundles[0].tags
    assert (tag.shift_noise, tag.turn_noise) == (0.0005, 0.005)  # defaults: the files have none
    assert np.allclose(bundles[1].tags[0].pose, matrix(np.diag([-1.0, -1.0, 1.0]), [1, 0, -0.5]))


def entries(**values):
    return [{"name": "b", "layout": [{"id": 1, "size": 0.1, **values}]}]


@pytest.mark.parametrize(
    "value, word",
    [
        (None, "tag_bundles is None, must be a list"),
        ([1], r"tag_bundles\[0\] is 1, must be a map"),
        ([{"name": "b"}], "layout of bundle 'b' is None, must be a list"),
        ([{"name": "b", "layout": []}], "number of tags of bundle 'b' is 0"),
        ([{"name": "b", "layout": [7]}], "a tag in the layout of bundle 'b' is 7, must be a map"),
        (entries() * 2, "'b' is there twice"),
        ([{"name": 5, "layout": []}], r"tag_bundles\[0\]: name is 5, must be a name of 1 to 255"),
        ([{"name": "", "layout": []}], r"tag_bundles\[0\]: name is '', must be a name of 1 to 255"),
        ([{"name": "b", "lay": []}], r"tag_bundles\[0\] has 'lay', must be name, family, layout"),
        ([{3: 4, "x": 1}], r"tag_bundles\[0\] has '3', must be name"),
        (entries(Qw=1.0), "tag in the layout of bundle 'b' has 'Qw', must be id, size, x, y, z, q"),
        (entries(id="x"), "id is 'x', must be a whole number"),
        (entries(id=-1), "is -1, must be at least 0"),
        (entries(size="big"), "tag 1: size is 'big', must be a number"),
        (entries(size=-0.1), "size of tag 1 of bundle 'b' is -0.1, must be above 0"),
        (entries(x=float("nan")), "x is nan, must be a number"),
        (entries(x=10**400), "x is 1000.*, must be a number"),
        (entries(size=1e300), r"size is 1e\+300, must be a number to 1e\+07"),
        (entries(size=101), "size is 101.0, must be above 0 and at most 100 m"),
        (entries(id=10**30), "id is 1000.*, must be a whole number to 999999999"),
        (entries(qw=0.0), "must have length 1"),
        (entries(shift_noise=-1), "shift_noise of tag 1 of bundle 'b' is -1, must be from 0 to 1"),
        (entries(turn_noise="a lot"), "tag 1: turn_noise is 'a lot', must be a number"),
        ([{"name": "b", "layout": entries()[0]["layout"] * 2}], "id of a tag .* is 1 twice"),
    ],
)
def test_invalid_bundles_are_named(value, word):
    with pytest.raises(ValueError, match=word):
        parse_bundles(value)


def test_a_file_is_replaced_only_if_it_may_be(tmp_path):
    path = tmp_path / "bundles.yaml"
    for name in ("old", "new"):
        write_bundles(str(path), [rv.Bundle(name, [rv.BundleTag(1, 0.1, np.eye(4))])])
    with pytest.raises(FileExistsError, match=f"^{path} cannot be written: File exists$"):
        write_bundles(
            str(path), [rv.Bundle("no", [rv.BundleTag(1, 0.1, np.eye(4))])], replace=False
        )
    assert [bundle.name for bundle in read_bundles(path)] == ["new"]
