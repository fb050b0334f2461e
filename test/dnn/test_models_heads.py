"""The head of a network is found from the shapes of its outputs, and from what the model says."""

import dataclasses

import pytest

from robot_vision.dnn.heads import EXPECTED, guess_head
from robot_vision.dnn.input_preferences import chosen
from robot_vision.dnn.model_facts import ModelFile
from robot_vision.dnn.network import NetworkSettings
from robot_vision.dnn.network_input import NetworkInput

ULTRALYTICS = {"stride": "32", "task": "detect"}
COCO = {**ULTRALYTICS, "names": str({number: f"class {number}" for number in range(80)})}
TWO = {"names": "{0: 'a', 1: 'b'}"}


def guess(shapes, size=(640, 640), names=(), metadata=None, kind="onnx", **options):
    operators = options.pop("operators", {})
    model = ModelFile("a", kind, b"", metadata=metadata or {}, operators=operators)
    network_input = NetworkInput("images", *size, "nchw", "float32")
    return guess_head(model, network_input, shapes, names, **options)


# What the families' own programs export, at the size of the input that is usual for them.
KNOWN = [
    ("yolov8", 80, [(1, 84, 8400)], {}),
    ("yolov8", 80, [(1, 84, 8400)], {"metadata": COCO}),
    ("yolov8", 80, [(1, 84, 3549)], {"size": (416, 416)}),
    ("yolov8", 80, [(1, 84, 6300)], {"size": (640, 480)}),
    ("yolov8", 80, [(1, 84, 34000)], {"size": (1280, 1280), "metadata": COCO}),
    ("yolov8", 1, [(1, 5, 8400)], {}),
    ("yolov5", 80, [(1, 25200, 85)], {}),
    ("yolov5", 1, [(1, 25200, 6)], {}),
    ("yolov5", 80, [(1, 102000, 85)], {"size": (1280, 1280)}),
    ("yolov10", 80, [(1, 300, 6)], {"metadata": {**COCO, "end2end": "True"}}),
    ("yolov10", 1000, [(1, 300, 6)], {}),
    ("yolox", 80, [(1, 3549, 85)], {"size": (416, 416)}),
    ("yolox", 80, [(1, 8400, 85)], {}),
    ("yolox", 107, [(1, 8400, 112)], {"counts": [107]}),
    ("nanodet", 80, [(1, 2125, 112)], {"size": (320, 320)}),
    ("nanodet", 80, [(1, 3598, 112)], {"size": (416, 416)}),
    ("nanodet", 80, [(1, 2100, 112)], {"size": (320, 320)}),
    ("nanodet", 3, [(1, 2100, 35)], {"size": (320, 320), "counts": [3]}),
    ("ssd", 20, [(1, 1, 100, 7)], {"size": (300, 300), "metadata": {"classes": "20"}}),
    ("ssd", 1000, [(1, 1, 0, 7)], {"size": (300, 300)}),
    ("ssd", 80, [(1, 200, 4), (1, 200), (1, 200)], {"counts": [80]}),
    ("detr", 91, [(1, 100, 92), (1, 100, 4)], {"size": (800, 800)}),
    ("detr", 3, [(1, 50, 4), (1, 50, 4)], {"names": ("logits", "pred_boxes")}),
    ("detr", 91, [(1, 300, 92), (1, 300, 4)], {"counts": [80, 90, 91]}),
    ("rtdetr", 80, [(1, 100, 80), (1, 100, 4)], {"counts": [80, 90, 91]}),
    ("ssd", 80, [(1, 1, 100, 7)], {"counts": [80, 90, 91]}),
    ("rtdetr", 80, [(1, 300, 84)], {"metadata": COCO}),
    ("rtdetr", 80, [(1, 300, 80), (1, 300, 4)], {}),
    ("rtdetr", 80, [(1, 100, 80), (1, 100, 4)], {"operators": {"GridSample": 6}}),
    ("rtdetr", 2, [(1, 300, 6)], {"metadata": {**TWO, "description": "Ultralytics RT-DETR-l"}}),
    ("yolov3", 80, [(507, 85), (2028, 85), (8112, 85)], {"kind": "darknet", "size": (416, 416)}),
]


@pytest.mark.parametrize("head, classes, shapes, told", KNOWN)
def test_the_usual_exports_of_each_family_are_known(head, classes, shapes, told):
    found = guess(shapes, **told)
    assert (found.head, found.classes, found.task) == (head, classes, "detect")
    assert found.counted == (classes != 1000)
    assert found.reason


TASKS = [
    ("yolov8", "segment", 80, [(1, 116, 8400), (1, 32, 160, 160)], {}),
    ("yolov8", "segment", 80, [(1, 32, 160, 160), (1, 116, 8400)], {}),
    ("yolov5", "segment", 80, [(1, 25200, 117), (1, 32, 160, 160)], {}),
    ("yolov8", "pose", 1, [(1, 56, 8400)], {}),
    ("yolov8", "pose", 2, [(1, 14, 8400)], {"metadata": {"task": "pose", "kpt_shape": "[4, 2]"}}),
    (
        "yolov8",
        "oriented",
        15,
        [(1, 20, 21504)],
        {"metadata": {"task": "obb"}, "size": (1024, 1024)},
    ),
    ("yolov8", "oriented", 15, [(1, 20, 8400)], {"task": "oriented"}),
    ("yolov8", "detect", 52, [(1, 56, 8400)], {"task": "detect"}),
    ("yolov8", "detect", 52, [(1, 56, 8400)], {"counts": [52]}),
]


@pytest.mark.parametrize("head, task, classes, shapes, told", TASKS)
def test_what_it_finds_besides_boxes_is_known(head, task, classes, shapes, told):
    found = guess(shapes, **told)
    assert (found.head, found.task, found.classes) == (head, task, classes)
    if task == "pose":
        shape = (4, 2) if "metadata" in told else (17, 3)
        assert (found.keypoints, found.keypoint_values) == shape
    if task == "segment":  # the decoder wants the boxes first
        assert len(shapes[found.order[0]]) == 3 and len(shapes[found.order[1]]) == 4


def test_outputs_come_to_the_decoder_in_its_order():
    shapes = {"scores": (1, 9), "boxes": (1, 9, 4), "labels": (1, 9)}
    for names in (["scores", "boxes", "labels"], ["labels", "scores", "boxes"]):
        found = guess([shapes[name] for name in names], names=names)
        assert [names[number] for number in found.order] == ["boxes", "labels", "scores"]
    found = guess([(1, 9), (1, 9, 4), (1, 9)], names=["scores", "boxes", "classes"])
    assert found.order == (1, 2, 0)
    found = guess([(1, 9), (1, 9, 4), (1, 9)], names=["probabilities", "boxes", "labels"])
    assert found.order == (1, 2, 0)
    found = guess([(1, 9, 4), (1, 9), (1, 9)])
    assert found.order == (0, 1, 2)
    for names in (["pred_boxes", "logits"], ["logits", "pred_boxes"]):
        found = guess([(1, 9, 4), (1, 9, 4)], names=names)
        assert [names[number] for number in found.order] == ["logits", "pred_boxes"]


FORCED = [
    ("yolov8", [(1, 84, 777)], 80),
    ("yolov5", [(1, 777, 85)], 80),
    ("yolox", [(1, 8400, 112)], 107),
    ("nanodet", [(1, 8400, 85)], 53),
    ("yolov10", [(1, 25200, 6)], 1000),
    ("rtdetr", [(1, 25200, 6)], 2),
    ("detr", [(1, 300, 81), (1, 300, 4)], 80),
    ("rtdetr", [(1, 100, 81), (1, 100, 4)], 81),
    ("yolov3", [(507, 85)], 80),
]


@pytest.mark.parametrize("head, shapes, classes", FORCED)
def test_the_user_has_the_last_word(head, shapes, classes):
    found = guess(shapes, head=head)
    assert (found.head, found.classes) == (head, classes)


UNFIT = [
    ([(1, 1000)], {}, "its output 1x1000 is that of a network that classifies whole images"),
    ([(1, 255, 80, 80), (1, 255, 40, 40), (1, 255, 20, 20)], {}, "are maps of features: export it"),
    ([(1, 777, 85, 2)], {}, "no head fits its outputs, 1x777x85x2, for an input of 640x640 px"),
    ([(2, 84, 8400)], {}, "no head fits its outputs, 2x84x8400"),
    ([(1, 84, 777000)], {"names": ["Boxes"]}, "no head fits its outputs, boxes 1x84x777000"),
    ([(1, 4, 8400)], {}, "no head fits"),
    # Boxes and scores of cells, as of YOLO-NAS: no queries.
    ([(1, 8400, 4), (1, 8400, 80)], {}, "no head fits its outputs, 1x8400x4, 1x8400x80"),
    # The network leaves out what overlaps, and gives poses, or oriented boxes.
    ([(1, 300, 57)], {"metadata": {"task": "pose", "end2end": "True"}}, "no head fits"),
    ([(1, 300, 7)], {"metadata": {"task": "obb", "end2end": "True"}}, "no head fits"),
    (
        [(1, 84, 8400)],
        {"head": "yolov10"},
        r"head is yolov10, which gives \(1, n, 6\); the network",
    ),
    ([(1, 84, 8400)], {"head": "yolov9"}, "head is 'yolov9', must be auto, yolov3, yolov5"),
    ([(1, 84, 8400)], {"task": "sing"}, "task is 'sing', must be auto, detect, segment"),
    ([(1, 84, 8400)], {"task": "segment"}, "task is segment, must be detect: 1x84x8400 has"),
    ([(1, 84, 8400)], {"metadata": {"task": "classify"}}, "its task is 'classify', must be detect"),
    ([()], {}, "no head fits its outputs, scalar"),
    ([], {}, "no head fits its outputs"),
]


@pytest.mark.parametrize("shapes, told, reason", UNFIT)
def test_what_fits_nothing_is_told_with_its_shapes(shapes, told, reason):
    with pytest.raises(ValueError, match=reason) as error:
        guess(shapes, **told)
    if "no head fits" in reason:
        assert all(f"{head} " in str(error.value) for head in EXPECTED)


def image_of(head, kind="onnx", description=b"", input_type="float32", outputs=(), **set_by_user):
    model = ModelFile("a", kind, b"", description)
    network_input = NetworkInput("images", 64, 64, "nchw", input_type)
    found = guess([(1, 84, 8400)])
    found = dataclasses.replace(found, head=head, order=outputs)
    return chosen(model, found, network_input, NetworkSettings("a", **set_by_user))


FAMILIES = [
    (("yolov8",), "letterbox with 114, rgb, (value - 0) / 255"),
    (("yolov5",), "letterbox with 114, rgb, (value - 0) / 255"),
    (("yolov3", "darknet"), "letterbox with 127, rgb, (value - 0) / 255"),
    (("yolox",), "corner with 114, bgr, (value - 0) / 1"),
    (("nanodet",), "stretch, bgr, (value - (103.53, 116.28, 123.675)) / (57.375, 57.12, 58.395)"),
    (("rtdetr",), "stretch, rgb, (value - 0) / 255"),
    (("detr",), "stretch, rgb, (value - (123.675, 116.28, 103.53)) / (58.395, 57.12, 57.375)"),
    (("ssd", "caffe", b'name: "conv1/dw"'), "stretch, bgr, (value - 127.5) / 127.5"),
    (("ssd", "caffe", b"VGG"), "stretch, bgr, (value - (104, 117, 123)) / 1"),
    (("ssd", "tensorflow"), "stretch, rgb, (value - 0) / 1"),
    (("ssd", "onnx", b"", "uint8"), "stretch, rgb, (value - 0) / 1"),
    (("ssd", "onnx"), "stretch, bgr, (value - 127.5) / 127.5"),
    (
        ("ssd", "onnx", b"", "float32", (0, 1, 2)),
        "stretch, rgb, (value - (123.675, 116.28, 103.53)) / (58.395, 57.12, 57.375)",
    ),
]


@pytest.mark.parametrize("what, text", FAMILIES)
def test_each_family_has_its_images_as_it_was_trained(what, text):
    assert str(image_of(*what)) == text


def test_the_user_can_set_how_images_are_given():
    image = image_of(
        "yolov8", fit="stretch", pad=0, order="bgr", mean=(1.0, 2.0, 3.0), std=(2.0, 2.0, 2.0)
    )
    assert str(image) == "stretch, bgr, (value - (1, 2, 3)) / 2" and image.pad == 0
    bad = [
        ({"fit": "crop"}, "fit is 'crop', must be auto, letterbox, stretch, corner"),
        ({"order": "gbr"}, "order is 'gbr', must be auto, rgb, bgr"),
        ({"pad": 256}, "pad is 256, must be from 0 to 255"),
        ({"mean": (1.0,)}, "mean is .1.0,., must be three numbers, or none"),
        ({"mean": (1.0, 2.0, float("nan"))}, "must be three numbers"),
        ({"std": (1.0, 0.0, 1.0)}, "std is .1.0, 0.0, 1.0., must be above 0"),
    ]
    for values, reason in bad:
        with pytest.raises(ValueError, match=reason):
            image_of("yolov8", **values)
