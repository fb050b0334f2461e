"""Layouts of bundles that are learnt from frames with noise, and their files."""

import numpy as np
import pytest
from tags import (
    CAMERAS,
    corners_of,
    error_of,
    faces_camera,
    in_picture,
    matrix,
    pose_in_view,
    turned,
)

import robot_vision as rv
from robot_vision.bundle_calibration import calibrate
from robot_vision.bundle_files import parse_bundles, read_bundles, write_bundles

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


def frames_of(rng, layout, camera, count, only=None, noise=NOISE):
    """Corners by tag, from about 1 m away and from many sides; only(frame) says which tags."""
    frames = []
    while len(frames) < count:
        body = pose_in_view(rng, rng.uniform(90, 170), rng.uniform(0, 1.1))
        tags = layout if only is None else only(len(frames))
        seen = {tag: corners_of(body @ layout[tag], camera, SIDE) for tag in tags}
        frames.append(
            {
                tag: corners + rng.normal(0.0, noise, (4, 2))
                for tag, corners in seen.items()
                if faces_camera(body @ layout[tag]) and in_picture(corners, camera)
            }
        )
    return frames


def worst(bundle, layout):
    """The largest errors of a bundle's tags: m, degrees."""
    errors = [error_of(tag.pose, layout[tag.id]) for tag in bundle.tags]
    return (
        max(np.linalg.norm(error[:3]) for error in errors),
        np.degrees(max(np.linalg.norm(error[3:]) for error in errors)),
    )


@pytest.mark.parametrize("model", CAMERAS)
@pytest.mark.parametrize("flat", [False, True], ids=["solid", "flat"])
def test_a_random_layout_is_recovered(model, flat):
    rng = np.random.default_rng(11)
    layout = random_layout(rng, 8, flat)
    frames = frames_of(rng, layout, CAMERAS[model], 300)
    before = [{tag: corners.copy() for tag, corners in frame.items()} for frame in frames]
    found = calibrate("box", frames, {tag: SIDE for tag in layout}, CAMERAS[model], MASTER)
    shift, turn = worst(found.bundle, layout)
    assert shift < 0.0005 and turn < 0.2
    assert found.bundle.name == "box" and found.bundle.tags[0].id == MASTER
    assert np.array_equal(found.bundle.tags[0].pose, np.eye(4))
    assert sorted(found.residuals) == sorted(layout)
    for residual in found.residuals.values():
        assert residual == pytest.approx(NOISE * np.sqrt(2), rel=0.15)
    assert found.frames == sum(len(frame) > 1 for frame in frames)
    assert found.rejected == 0
    assert found.sightings == {
        tag: sum(tag in frame for frame in frames if len(frame) > 1) for tag in layout
    }
    for frame, old in zip(frames, before):
        assert all(np.array_equal(frame[tag], old[tag]) for tag in old)


def test_exact_corners_give_the_exact_layout():
    rng = np.random.default_rng(16)
    layout = random_layout(rng, 3, False)
    frames = frames_of(rng, layout, CAMERAS["equidistant"], 10, noise=0.0)
    sizes = {tag: SIDE for tag in layout}
    found = calibrate("box", frames, sizes, CAMERAS["equidistant"], MASTER)
    shift, turn = worst(found.bundle, layout)
    assert shift < 1e-5 and turn < 1e-3 and found.rejected == 0


def test_tags_are_linked_by_others_where_the_master_is_out_of_sight():
    """Only neighbours in a row are seen together, and other tags than those asked for appear."""
    rng = np.random.default_rng(12)
    camera = CAMERAS["plumb_bob"]
    layout = {MASTER + i: matrix(turned([0, -0.4 * i, 0]), [0.2 * i, 0, 0]) for i in range(4)}
    frames = frames_of(rng, layout, camera, 200, lambda i: (MASTER + i % 3, MASTER + 1 + i % 3))
    for frame in frames:
        frame[99] = np.zeros((4, 2))
    sizes = {tag: SIDE for tag in layout}
    found = calibrate("row", frames, sizes, camera, MASTER)
    shift, turn = worst(found.bundle, layout)
    assert shift < 0.001 and turn < 0.4
    # Of another master's view it is the same body.
    other = calibrate("row", frames, sizes, camera, MASTER + 2)
    inverse = np.linalg.inv(layout[MASTER + 2])
    shift, turn = worst(other.bundle, {tag: inverse @ pose for tag, pose in layout.items()})
    assert shift < 0.001 and turn < 0.4


def test_a_few_tags_somewhere_else_are_rejected():
    rng = np.random.default_rng(13)
    camera = CAMERAS["plumb_bob"]
    layout = random_layout(rng, 4, False)
    frames = frames_of(rng, layout, camera, 120)
    for frame in frames[::20]:
        for tag in list(frame)[:1]:
            frame[tag] = frame[tag] + 40.0  # somewhere else
    found = calibrate("box", frames, {tag: SIDE for tag in layout}, camera, MASTER)
    shift, turn = worst(found.bundle, layout)
    assert shift < 0.0005 and turn < 0.2
    assert 6 <= found.rejected <= 18  # of two tags that contradict each other, both
    # All is twice as large and twice as far away.
    double = calibrate("box", frames, {tag: 2 * SIDE for tag in layout}, camera, MASTER)
    for one, two in zip(found.bundle.tags, double.bundle.tags):
        assert np.allclose(2 * one.pose[:3, 3], two.pose[:3, 3], atol=2e-5)


def test_what_cannot_be_learnt_is_named():
    rng = np.random.default_rng(14)
    camera = CAMERAS["plumb_bob"]
    layout = random_layout(rng, 4, True)
    sizes = {tag: SIDE for tag in layout}
    frames = frames_of(rng, layout, camera, 30)

    def refused(*args):
        with pytest.raises(ValueError) as error:
            calibrate("box", *args)
        return str(error.value)

    assert "master tag 7 has no size" in refused(frames, sizes, camera, 7)
    assert "tag 10 alone" in refused(frames, {10: SIDE}, camera, 10)
    assert "tag 42 was not seen in any of 30 frames" in refused(
        frames, {**sizes, 42: SIDE}, camera, MASTER
    )
    without = [{tag: c for tag, c in frame.items() if tag != MASTER} for frame in frames]
    assert "master tag 10 was not seen" in refused(without, sizes, camera, MASTER)
    pairs = frames_of(rng, layout, camera, 30, lambda i: [(10, 11), (12, 13)][i % 2])
    assert "tags [12, 13] were never seen together with the master tag 10" in refused(
        pairs, sizes, camera, MASTER
    )
    alone = [{tag: frame[tag]} for frame in frames for tag in frame]
    assert "tags [11, 12, 13] were never seen together" in refused(alone, sizes, camera, MASTER)
    assert "size of tag 11" in refused(frames, {**sizes, 11: 0.0}, camera, MASTER)
    assert "master tag 10 was not seen in any of 0 frames" in refused([], sizes, camera, MASTER)
    many = frames_of(rng, layout, camera, 60)
    loose = [
        {tag: c for tag, c in frame.items() if tag != 13 or i < 9} for i, frame in enumerate(many)
    ]
    for frame in loose[:9]:
        if 13 in frame:
            frame[13] = frame[13] + rng.uniform(-100, 100, 2)
    assert "tags [13] are not on one rigid body" in refused(loose, sizes, camera, MASTER)
    index = next(i for i, frame in enumerate(frames) if i > 5 and len(frame) > 1)
    tag = next(iter(frames[index]))
    frames[index][tag] = np.full((4, 2), np.nan)
    assert f"frame {index}: corners of tag {tag}" in refused(frames, sizes, camera, MASTER)


def test_a_bundle_is_read_as_it_was_written(tmp_path):
    rng = np.random.default_rng(15)
    path = tmp_path / "bundles.yaml"
    path.write_text("an old file")
    bundles = [
        rv.Bundle(
            name,
            [
                rv.BundleTag(i, 0.1 + i / 7, pose)
                for i, pose in random_layout(rng, 5, False).items()
            ],
        )
        for name in ("box", 'it\'s: a #1 "name"')
    ]
    write_bundles(str(path), bundles)
    assert [entry.name for entry in tmp_path.iterdir()] == ["bundles.yaml"]
    for wrote, read in zip(bundles, read_bundles(str(path))):
        assert wrote.name == read.name
        assert [tag.id for tag in wrote.tags] == [tag.id for tag in read.tags]
        for one, two in zip(wrote.tags, read.tags):
            assert one.size == two.size and np.allclose(one.pose, two.pose, atol=1e-6)


def test_files_of_apriltag_ros_are_read():
    """Its names are optional, and so are the parts of a pose that are 0."""
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
        ([{"name": "b", "layout": [7]}], "layout of bundle 'b' has 7, must have maps"),
        (entries() * 2, "'b' is there twice"),
        (entries(id="x"), "id is 'x', must be a whole number"),
        (entries(id=-1), "is -1, must be at least 0"),
        (entries(size="big"), "tag 1: size is 'big', must be a number"),
        (entries(size=-0.1), "size of tag 1 of bundle 'b' is -0.1, must be above 0"),
        (entries(x=float("nan")), "x is nan, must be a number"),
        (entries(qw=0.0), "must have length 1"),
        ([{"name": "b", "layout": entries()[0]["layout"] * 2}], "id of a tag .* is 1 twice"),
    ],
)
def test_what_is_no_bundle_is_named(value, word):
    with pytest.raises(ValueError, match=word):
        parse_bundles(value)


@pytest.mark.parametrize(
    "text, word", [("", "no tag_bundles"), ("a: [", "no valid YAML"), ("tag_bundles: 3", "list")]
)
def test_what_is_no_file_of_bundles_is_named(tmp_path, text, word):
    path = tmp_path / "bundles.yaml"
    path.write_text(text)
    with pytest.raises(ValueError, match=f"{path}.*{word}"):
        read_bundles(str(path))
