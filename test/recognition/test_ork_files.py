"""The .ork files of object_recognition_core are read, and what is not used of them is told."""

import pytest

from robot_vision.recognition import detection
from robot_vision.recognition.database import Database, Model, Object
from robot_vision.recognition.ork_file import Cell, read_ork
from robot_vision.recognition.ork_node import node_words, with_typed
from robot_vision.recognition.ork_pipelines import (
    ALL,
    MISSING,
    Pipeline,
    chosen_objects,
    object_choice,
    pipelines_of,
    unknown_warnings,
)

COUCH = {"type": "CouchDB", "root": "http://localhost:5984", "collection": "object_recognition"}
DB = """
    db:
      type: 'CouchDB'
      root: 'http://localhost:5984'
      collection: 'object_recognition'
"""
KINECT = """
source1:
  type: RosKinect
  module: 'object_recognition_ros.io'
  parameters:
    rgb_frame_id: 'camera_rgb_optical_frame'
    rgb_image_topic: '/camera/rgb/image_rect_color'
    depth_image_topic: '/camera/depth_registered/image_raw'
"""
# Files in the forms in which object_recognition_core's packages publish theirs.
LINEMOD_TRAINING = f"""
pipeline1:
  type: LinemodTrainer
  module: 'object_recognition_linemod'
  parameters:
    # The list of object_ids to analyze
    object_ids: 'all'{DB}
"""
LINEMOD_DETECTION = f"""{KINECT}
sink1:
  type: Publisher
  module: 'object_recognition_ros.io'
  inputs: [source1]
pipeline1:
  type: LinemodDetector
  module: 'object_recognition_linemod'
  subtype: 'DefaultLINEMOD'
  inputs: [source1]
  outputs: [sink1]
  parameters:
    object_ids: ['ed149575c2a44c1c095c5bc1b80c3038', 'coke']
    threshold: 93.5
    visualize: True
    icp_dist_min: 0.06
    renderer_n_points: 150{DB}
"""
TOD_TRAINING = f"""
pipeline1:
  type: TodTrainer
  module: object_recognition_tod
  parameters:
    feature: {{type: ORB, n_features: 1000, n_levels: 3, scale_factor: 1.2}}
    descriptor:
      type: ORB
      module: ecto_opencv.features2d
    search: {{key_size: 24, n_tables: 8, radius: 55, ratio: 0.8, type: 'LSH'}}{DB}
    object_ids: "all"
"""
TABLETOP = f"""{KINECT}
sink1:
  type: TablePublisher
  module: 'object_recognition_tabletop'
  inputs: [source1]
sink2:
  type: Publisher
  module: 'object_recognition_ros.io'
  inputs: [source1]
  visualize: True
voter1:
  type: 'Aggregator'
  module: 'object_recognition_core.io'
pipeline1:
  type: TabletopTableDetector
  module: 'object_recognition_tabletop'
  inputs: [source1]
  outputs: [sink1]
  parameters:
    table_detector:
        min_table_size: 4000
        plane_threshold: 0.01
pipeline2:
  type: TabletopObjectDetector
  module: 'object_recognition_tabletop'
  inputs: [source1, pipeline1]
  outputs: [sink2]
  parameters:
    object_ids: 'missing'
    tabletop_object_ids: 'REDUCED_MODEL_SET'{DB}
"""
JSON = """
cell:
  type: LINEMOD
  inputs: [source1]
pipeline1:
  method: 'LINEMOD'
  submethod: 'DefaultLINEMOD'
  package: 'object_recognition_linemod'
  parameters:
    json_submethod: '{"views": 500, "seed": 1}'
    json_db: '{"type": "CouchDB", "root": "http://localhost:5984"}'
    object_ids: "['coke', '4680']"
    object_names: ['bottle']
    seed: 2
"""


def written(tmp_path, text):
    path = tmp_path / "some.ork"
    path.write_text(text)
    return str(path)


def read(tmp_path, text):
    """The pipelines of a file, and the warnings."""
    file = read_ork(written(tmp_path, text))
    return pipelines_of(file), file.warnings


def test_of_linemod(tmp_path):
    training, warnings = read(tmp_path, LINEMOD_TRAINING)
    assert training == [Pipeline("pipeline1", "LINEMOD", ALL, COUCH, {})] and warnings == []
    (detection,), warnings = read(tmp_path, LINEMOD_DETECTION)
    ids = ["ed149575c2a44c1c095c5bc1b80c3038", "coke"]
    assert detection == Pipeline("pipeline1", "LINEMOD", ids, COUCH, {})
    assert warnings == [
        "pipeline1: icp_dist_min is not used: the noise of the depths says what fits",
        "pipeline1: renderer_n_points is not used: this renderer needs none of them",
        "pipeline1: threshold is not used: the threshold of the live parameters is a probability",
        "pipeline1: visualize is not used: what is found is drawn on ~processed_image",
    ]
    file = read_ork(written(tmp_path, LINEMOD_DETECTION))
    topics = {
        "rgb_frame_id": "camera_rgb_optical_frame",
        "rgb_image_topic": "/camera/rgb/image_rect_color",
        "depth_image_topic": "/camera/depth_registered/image_raw",
    }
    assert file.sources == [Cell("source1", "RosKinect", topics)]
    assert file.sinks == [Cell("sink1", "Publisher", {})]


def test_images_are_rectified_if_the_topic_that_is_used_in_the_end_says_so(tmp_path):
    words = node_words(read_ork(written(tmp_path, LINEMOD_DETECTION)))
    rectified = "_rectified:=true"
    assert words[0] == "image:=/camera/rgb/image_rect_color"
    assert with_typed(words, []) == [*words, rectified]
    assert with_typed(words, ["_rectified:=false"]) == [*words, rectified, "_rectified:=false"]
    for topic, added in {"/camera/rgb/image_raw": [], "/left/image_rect": [rectified]}.items():
        assert with_typed(words, [f"image:={topic}"]) == [*words, *added, f"image:={topic}"]
    both = ["image:=/left/image_rect", "depth:=/camera/depth_registered/sw_registered/image_rect"]
    assert with_typed(words, both) == [*words, rectified, "_depth_rectified:=true", *both]


def test_of_tod_and_tabletop(tmp_path):
    (tod,), _ = read(tmp_path, TOD_TRAINING)
    assert (tod.method, tod.objects, tod.parameters["search"]["radius"]) == ("TOD", ALL, 55)
    (tables, objects), warnings = read(tmp_path, TABLETOP)
    assert (tables.method, tables.db) == ("TABLES", {})
    assert tables.parameters == {
        "table_detector": {"min_table_size": 4000, "plane_threshold": 0.01}
    }
    assert (objects.method, objects.objects, objects.on_tables) == ("LINEMOD", MISSING, True)
    assert not tables.on_tables
    assert warnings == [
        "voter1 is not used: cells that vote are not needed",
        "pipeline2: tabletop_object_ids is not used: object_ids says which objects",
    ]
    assert read_ork(written(tmp_path, TABLETOP)).sinks[1].parameters == {"visualize": True}


def test_of_older_forms_with_json(tmp_path):
    (pipeline,), warnings = read(tmp_path, JSON)
    assert pipeline.method == "LINEMOD"
    assert pipeline.db == {"type": "CouchDB", "root": "http://localhost:5984"}
    assert pipeline.objects == ["coke", "4680", "bottle"]
    assert pipeline.parameters == {"views": 500, "seed": 2}
    assert warnings == ["cell is not used: what it is cannot be told"]
    assert unknown_warnings("pipeline1", pipeline.parameters, ["views"]) == [
        "pipeline1: seed is not known, and not used"
    ]


@pytest.mark.parametrize(
    "text, said",
    [
        ("", "some.ork: it is None, must be cells by name"),
        ("[1, 2]", r"some.ork: it is \[1, 2\], must be cells by name"),
        ("pipeline1: {type: [", "some.ork: line 1, column 20: "),
        ("pipeline1: LINEMOD", "some.ork: pipeline1 is 'LINEMOD', must be a cell"),
        ("pipeline1: {parameters: {}}", "some.ork: pipeline1: type is '', must be a name"),
        ("pipeline1: {type: 7}", "some.ork: pipeline1: type is 7, must be a name"),
        ("source1: {type: RosKinect}", "some.ork: there is no pipeline in it"),
        (
            "pipeline1: {type: TransparentObjectsDetector}",
            "some.ork: pipeline1: type is 'TransparentObjectsDetector', must be one of LinemodDet",
        ),
        ("pipeline1: {type: LINEMOD, parameters: 3}", "some.ork: pipeline1: parameters is 3, must"),
        ("pipeline1: {type: LINEMOD, object_ids: 3}", "object_ids is 3, must be 'all', 'missing'"),
        ("pipeline1: {type: LINEMOD, object_ids: [3]}", r"object_ids is \[3\], must be 'all', 'mi"),
        ("pipeline1: {type: LINEMOD, object_ids: '[3'}", "pipeline1: object_ids: line 1, column"),
        ("pipeline1: {type: LINEMOD, db: 'x'}", "pipeline1: db is 'x', must be a map with type"),
        ("pipeline1: " + "[" * 30, "some.ork: line 1, column 31: nested deeper than 20 levels"),
        ("pipeline1: {type: LINEMOD, json_submethod: '{'}", "some.ork: pipeline1: line 1"),
    ],
)
def test_what_is_wrong_is_named(tmp_path, text, said):
    with pytest.raises(ValueError, match=said):
        read(tmp_path, text)


def test_files_that_are_none(tmp_path):
    for path in (tmp_path, tmp_path / "none.ork", "/dev/zero"):
        with pytest.raises(OSError, match=f"{path} cannot be read: "):
            read_ork(str(path))
    (tmp_path / "bytes.ork").write_bytes(b"\xff\xfe")
    with pytest.raises(ValueError, match=r"bytes\.ork: 'utf-8' codec"):
        read_ork(str(tmp_path / "bytes.ork"))


def test_what_pipelines_do_not_share_is_told(tmp_path, capsys):
    """One node has the database, the tables and the objects of all of them."""
    paths = [tmp_path / f"{name}.db" for name in ("first", "second")]
    with Database(str(paths[0]), write=True) as database, database.transaction():
        ids = [database.objects.add(Object(name)).id for name in ("coke", "mug")]
    cells = [
        f"pipeline{1 + index}: {{type: {kind}, object_names: [{name}], db: {{root: {path}}}}}"
        for index, (kind, name, path) in enumerate(
            zip(("TabletopObjectDetector", "TodDetector"), ("coke", "mug"), paths)
        )
    ]
    file = written(tmp_path, "\n".join(cells))
    words = detection.words_of(detection.parse_arguments(["-c", file]))
    assert capsys.readouterr().err.splitlines() == [
        f"warning: {file}: pipeline1: not only tables are looked at, as for other pipelines",
        f"warning: {file}: pipeline2: {paths[1]} is not used: the database is that of pipeline1",
        f"warning: {file}: pipeline1: LINEMOD looks for the objects of other pipelines, too",
        f"warning: {file}: pipeline2: TOD looks for the objects of other pipelines, too",
    ]
    assert f'_database:="{paths[0]}"' in words and "_on_tables:=true" not in words
    assert f'_objects:="{",".join(ids)}"' in words
    same = ["--database", str(paths[0]), "--object_names", "[mug]"]
    detection.words_of(detection.parse_arguments(["-c", file, *same]))
    assert capsys.readouterr().err.count("warning") == 1


@pytest.mark.parametrize(
    "pipelines, told",
    [
        (["Linemod [coke]", "Linemod [mug]"], []),
        (["Linemod [coke, mug]", "Tod [coke]", "Tod [mug]"], []),
        (["Linemod [coke]", "Tod [coke]", "Linemod [mug]"], ["pipeline2: TOD"]),
        (["Linemod [coke]", "Linemod [mug]", "Tod all"], ["pipeline1, pipeline2: LINEMOD"]),
    ],
)
def test_a_method_that_looks_for_objects_of_others_is_told(tmp_path, capsys, pipelines, told):
    path = tmp_path / "objects.db"
    with Database(str(path), write=True) as database, database.transaction():
        for name in ("coke", "mug"):
            database.objects.add(Object(name))
    cells = []
    for index, words in enumerate(pipelines):
        kind, names = words.split(" ", 1)
        choice = f"object_{'ids' if names == 'all' else 'names'}: {names}"
        cells.append(f"pipeline{1 + index}: {{type: {kind}Detector, {choice}}}")
    file = written(tmp_path, "\n".join(cells))
    detection.words_of(detection.parse_arguments(["-c", file, "--database", str(path)]))
    said = "looks for the objects of other pipelines, too"
    warnings = [f"warning: {file}: {one} {said}" for one in told]
    assert capsys.readouterr().err.splitlines() == warnings


@pytest.mark.parametrize(
    "value, choice",
    [
        ("all", ALL),
        ("missing", MISSING),
        ("coke", ["coke"]),
        ("[coke, 4680aac5]", ["coke", "4680aac5"]),
        ('["coke"]', ["coke"]),
        (["coke"], ["coke"]),
        ("[468, 012, coke]", ["468", "012", "coke"]),
        ("46803127", ["46803127"]),
    ],
)
def test_which_objects(value, choice):
    assert object_choice(value, "object_ids") == choice


@pytest.mark.parametrize("value", [[468, "coke"], "{coke: 1}", "[[coke]]", ""])
def test_which_objects_must_be_texts(value):
    """YAML has made numbers of digits in a file: with a 0 in front these are other ones."""
    with pytest.raises(ValueError, match=r"must be 'all', .* digits alone in quotes"):
        object_choice(value, "object_ids")


def test_objects_are_chosen_from_the_database(tmp_path):
    with Database(str(tmp_path / "objects.db"), write=True) as database:
        with database.transaction():
            coke, bottle, box = (
                database.objects.add(Object(name)) for name in ("coke", "bottle", "box")
            )
            database.models.set(Model(coke.id, "LINEMOD", {}, "a", b""))
            database.models.set(Model(box.id, "PPF", {}, "b", b""))

        def names(objects):
            pipeline = Pipeline("pipeline1", "LINEMOD", objects, {}, {})
            return [one.name for one in chosen_objects(database, pipeline)]

        assert names(ALL) == ["bottle", "box", "coke"]
        assert names(MISSING) == ["bottle", "box"]
        assert names(["coke", coke.id, bottle.id]) == ["bottle", "coke"]
        with pytest.raises(ValueError, match="there is no object 'can'"):
            names(["coke", "can"])
