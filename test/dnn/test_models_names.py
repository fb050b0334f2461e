"""The names of classes come from the model, or from a file of lines or YAML."""

import os

import pytest

from robot_vision.dnn.class_names import given_names, names_for, read_names
from robot_vision.dnn.head import Head
from robot_vision.dnn.metadata import class_names

FILES = [
    ("a.names", "cup\nbottle\n\n# a comment\n  fork \n", ["cup", "bottle", "fork"]),
    ("a.txt", "\ufeffcup\r\ntraffic light\r\n", ["cup", "traffic light"]),
    ("a.txt", "Stra\u00dfe\nno", ["Stra\u00dfe", "no"]),
    ("a.yaml", "names: [cup, bottle]", ["cup", "bottle"]),
    ("a.yaml", "path: x\nnc: 2\nnames:\n  0: cup\n  1: bottle\n", ["cup", "bottle"]),
    ("a.yaml", "names: {1: bottle, 0: cup, 3: fork}", ["cup", "bottle", "class 2", "fork"]),
    ("a.yml", "yolo_model:\n  detection_classes:\n    names:\n      - cup\n", ["cup"]),
    ("a.yaml", "- cup\n- 7\n", ["cup", "7"]),
]


@pytest.mark.parametrize("name, text, names", FILES)
def test_names_are_read_from_the_usual_files(tmp_path, name, text, names):
    path = tmp_path / name
    path.write_bytes(text.encode())
    assert read_names(str(path)) == names


def test_names_of_the_model_that_are_too_long_are_not_read():
    assert class_names({"names": "[" + "a" * 250000 + "]"}) == ["a" * 250000]
    assert class_names({"names": "[" + "a" * 270000 + "]"}) == []


BAD = [
    ("a.txt", b"", "it has 0 names of classes, must have 1 to 10000"),
    ("a.txt", b"a\n" * 10001, "it has 10001 names of classes"),
    ("a.txt", b"\xff\xfe", "it is no text in UTF-8"),
    ("a.yaml", b"names: cup", "it has 0 names of classes"),
    ("a.yaml", b"{}", "it has 0 names of classes"),
    ("a.yaml", b"names: {a: cup}", "it has 0 names of classes"),
    ("a.yaml", b"names: {-1: cup}", "it has 0 names of classes"),
    ("a.yaml", b"names: {999999999: cup}", "it has 0 names of classes"),
    ("a.yaml", b"names: [", "line 1, column"),
]


@pytest.mark.parametrize("name, content, reason", BAD)
def test_a_file_without_names_is_told(tmp_path, name, content, reason):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(ValueError, match=reason) as error:
        read_names(str(path))
    assert str(error.value).startswith(f"{path}: ")


def test_only_files_have_names(tmp_path):
    os.mkfifo(tmp_path / "a.txt")
    with pytest.raises(OSError, match="it is no file"):
        read_names(str(tmp_path / "a.txt"))


METADATA = [
    ("{0: 'cup', 1: \"driver's cup\"}", ["cup", "driver's cup"]),
    ('{"0": "cup"}', []),
    ("['cup', 'fork']", ["cup", "fork"]),
    ("{0: ['cup']}", []),
    ("[" * 1000, []),
    ("__import__('os')", []),
    ("", []),
]


@pytest.mark.parametrize("text, names", METADATA)
def test_names_in_a_model_are_read_without_running_them(text, names):
    assert class_names({"names": text}) == names


def test_a_class_without_a_name_has_its_number():
    assert names_for({}, Head("yolov8", "", 2), []) == ["class 0", "class 1"]


def test_a_file_has_precedence_over_the_model():
    metadata = {"names": "['cup', 'fork']"}
    assert names_for(metadata, Head("yolov8", "", 2), []) == ["cup", "fork"]
    assert names_for(metadata, Head("yolov8", "", 2), [["a", "b\n"]], "x.txt") == ["a", "b\\n"]


def test_known_names_fit_each_way_of_counting():
    coco = given_names("coco")
    assert len(set(coco[0])) == 80
    for classes, of_laptop in ((80, 63), (90, 72), (91, 73)):
        names = names_for({}, Head("detr", "", classes), coco, "coco")
        assert len(names) == classes and names[of_laptop] == "laptop"
        assert (names[0], names[-1]) == ("class 0" if classes == 91 else "person", "toothbrush")
    (voc,) = given_names("voc")
    assert len(set(voc)) == 20 and voc == sorted(voc) and voc[14] == "person"
    assert given_names("") == []
    with pytest.raises(ValueError, match=r"^coco has 80 names, but the network has 3 classes"):
        names_for({}, Head("yolov8", "", 3), coco, "coco")


def test_another_number_of_names_is_told_in_one_sentence():
    with pytest.raises(ValueError) as error:
        names_for({}, Head("yolov8", "", 80), [["cup"]], "cups.txt")
    assert str(error.value) == "cups.txt has 1 name, but the network has 80 classes"
    with pytest.raises(ValueError) as error:
        names_for({"names": "['cup', 'fork']"}, Head("yolov8", "", 1), [])
    assert str(error.value) == "the model's metadata has 2 names, but the network has 1 class"


def test_a_text_that_takes_long_to_read_has_no_names():
    assert class_names({"names": str(["a" * 1000] * 200)}) == ["a" * 1000] * 200
    assert class_names({"names": str(["a" * 300_000])}) == []
