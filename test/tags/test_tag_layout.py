"""The parameters for sizes, names and bundles of tags."""

import pytest

from robot_vision.tags.tag_layout import TagKey, TagLayout

BUNDLE = {"name": "box", "layout": [{"id": 1, "size": 0.1}, {"id": 2, "size": 0.1, "x": 0.3}]}


def test_defaults():
    layout = TagLayout("tag36h11", 0.1)
    tag = TagKey("tag36h11", 12)
    assert (layout.families, layout.bundles) == (["tag36h11"], [])
    assert (layout.size(tag), layout.frame_id(tag)) == (0.1, "tag_12")


def test_sizes_and_names_by_id_range_and_family():
    layout = TagLayout(
        " tag25h9,tag36h11 ",
        0.1,
        [
            {"id": 7, "size": 0.2, "name": "dock"},
            {"ids": "10-11, 12", "size": 0.05},
            {"ids": 20, "size": 0.3},
            {"id": 7, "family": "tag36h11", "size": 1},
        ],
        [BUNDLE],
    )
    sizes = {n: layout.size(TagKey("tag25h9", n)) for n in (1, 7, 9, 10, 12, 13, 20)}
    assert sizes == {1: 0.1, 7: 0.2, 9: 0.1, 10: 0.05, 12: 0.05, 13: 0.1, 20: 0.3}
    assert layout.size(TagKey("tag36h11", 7)) == 1.0
    names = [layout.frame_id(TagKey(*tag)) for tag in (("tag25h9", 7), ("tag36h11", 7))]
    assert names == ["dock", "tag36h11_7"]
    (bundle,) = layout.bundles
    assert (bundle.family, bundle.bundle.name) == ("tag25h9", "box")


def test_tags_may_be_renumbered():
    tags = [{"id": 5, "name": "tag_6"}, {"id": 6, "name": "tag_5"}, {"id": 7, "name": "tag_7"}]
    layout = TagLayout("tag36h11", 0.1, [*tags, {"id": 9, "name": "tag_99999"}])
    assert layout.frame_id(TagKey("tag36h11", 6)) == "tag_5"


def test_a_list_of_families():
    assert TagLayout(["tag16h5", "tag25h9"], 1).families == ["tag16h5", "tag25h9"]


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("", 0.1), "tag36h11"),
        (([], 0.1, [{"id": 1}]), "families is empty, must be at least one"),
        (([], 0.1, [], [BUNDLE]), "families is empty, must be at least one"),
        ((7, 0.1), "families is 7, must be names between commas"),
        (("tag36h11, tag36h11", 0.1), "families has 'tag36h11' twice"),
        (("tag36h11", 0), "tag_size is 0, must be above 0 and at most 100 m"),
        (("tag36h11", float("nan")), "tag_size is nan"),
        (("tag36h11", True), "tag_size is True"),
        (("tag36h11", 0.1, {}), "standalone_tags is {}, must be a list"),
        (("tag36h11", 0.1, [3]), "standalone_tags[0] is 3, must be a map"),
        (("tag36h11", 0.1, [{"id": 1, "sise": 2}]), "standalone_tags[0] has 'sise', must be id"),
        (("tag36h11", 0.1, [{"size": 1}]), "standalone_tags[0] must have either id or ids"),
        (("tag36h11", 0.1, [{"id": "1"}]), "id is '1', must be a whole number"),
        (("tag36h11", 0.1, [{"id": -1}]), "id is -1, tag36h11 has 0 to 586"),
        (("tag36h11", 0.1, [{"ids": "580-590"}]), "[0]: id is 590, tag36h11 has 0 to 586"),
        (("tag36h11", 0.1, [{"id": 1, "size": -1}]), "standalone_tags[0]: size is -1, must be"),
        (("tag36h11", 0.1, [{"ids": "1-2", "name": "a"}]), "name is 'a', but there are 2 tags"),
        (("tag36h11", 0.1, [{"id": 1, "family": "tag25h9"}]), "must be one of families: tag36h11"),
        (("tag36h11", 0.1, [{"id": 1}, {"ids": "0-2"}]), "tag 1 of tag36h11 is there twice"),
        (
            ("tag36h11", 0.1, [{"id": 1, "name": "a"}, {"id": 2, "name": "a"}]),
            "tag 1 of tag36h11 and tag 2 of tag36h11 have the same transform 'a'",
        ),
        (
            ("tag36h11", 0.1, [{"id": 7, "name": "tag_5"}]),
            "tag 5 of tag36h11 and tag 7 of tag36h11 have the same transform 'tag_5'",
        ),
        (
            ("tag36h11,tag25h9", 0.1, [], [{**BUNDLE, "name": "tag25h9_3"}]),
            "tag 3 of tag25h9 and bundle 'tag25h9_3' have the same transform 'tag25h9_3'",
        ),
        (
            ("tag36h11", 0.1, [{"id": 5, "name": "box"}], [BUNDLE]),
            "tag 5 of tag36h11 and bundle 'box' have the same transform 'box'",
        ),
        (
            ("tag36h11", 0.1, [{"id": 1, "size": 0.2}], [BUNDLE]),
            "bundle 'box': tag 1 of tag36h11 has size 0.1, elsewhere 0.2",
        ),
        (
            ("tag36h11", 0.1, [], [{"name": "b", "layout": [{"id": 9999, "size": 1}]}]),
            "bundle 'b': id is 9999, tag36h11 has 0 to 586",
        ),
    ],
)
def test_wrong_parameters_are_named(arguments, text):
    with pytest.raises(ValueError) as error:
        TagLayout(*arguments)
    assert text in str(error.value)
