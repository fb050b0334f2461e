"""What a model's files say, and what is said of files that are none."""

import os
import struct

import networks
import numpy as np
import onnx
import pytest
from network_files import CAFFE, CAFFE_MODEL, DARKNET, darknet_weights
from network_graph import SIZE, Graph
from networks import ULTRALYTICS, yolov8
from onnx import TensorProto

from robot_vision.dnn.model_file import read_model
from robot_vision.dnn.network_input import NetworkInput, input_of

TENSORFLOW = """
node { name: "picture" op: "Placeholder"
  attr { key: "dtype" value { type: DT_UINT8 } }
  attr { key: "shape" value { shape {
    dim { size: -1 } dim { size: 240 } dim { size: 320 } dim { size: 3 }
  } } }
}
node { name: "detection_out" op: "DetectionOutput" input: "a"  # a comment { "
  attr { key: "num_classes" value { i: 91 } }  # op: "Ghost"
}
"""


@pytest.fixture
def write(tmp_path):
    """write("a.onnx", content) makes a file, and returns its path."""

    def written(name, content):
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return str(path)

    return written


def changed(content, change):
    """An ONNX file after a function has changed the model in it."""
    model = onnx.ModelProto.FromString(content)
    change(model)
    return model.SerializeToString()


def test_an_onnx_file_is_known_without_a_run(write):
    model = read_model(write("a.onnx", yolov8(metadata={**ULTRALYTICS, "task": "detect"})))
    assert (model.kind, model.producer, model.opset) == ("onnx", "tests", 12)
    assert [str(one) for one in model.inputs] == ["images 1x3x64x64 float32"]
    assert [str(one) for one in model.outputs] == ["output0 1x7x84 float32"]
    assert model.operators == {"Conv": 3, "Reshape": 3, "Concat": 2, "Identity": 1}
    assert model.metadata["names"] == "{0: 'red', 1: 'green', 2: 'blue'}"
    assert not model.half and not model.dynamic and model.custom == () and model.warnings == ()
    boxes, scores = 4 * 84, 9 * (64 + 256 + 1024)
    assert model.parameters == boxes + scores + 3 * 3  # and three shapes
    assert input_of(model) == NetworkInput("images", SIZE, SIZE, "nchw", "float32")


def test_the_content_tells_an_onnx_file_of_another_name(write):
    assert read_model(write("model.bin", yolov8())).kind == "onnx"


def test_half_precision_and_open_sizes_are_seen(write):
    graph = Graph(("batch", 3, "height", "width"), TensorProto.FLOAT16)
    model = read_model(write("a.onnx", yolov8(graph=graph)))
    assert model.half and model.dynamic
    assert str(model.inputs[0]) == "images ?x3x?x? float16"


def test_operators_of_others_are_custom_also_inside_of_a_condition(write):
    graph = Graph()
    value = graph.custom("Boxes", "their.domain", graph.scores())
    graph.output(graph.custom("Gelu", "com.microsoft", value), "output", [1, 3, 84])
    model = read_model(write("a.onnx", graph.bytes()))
    assert model.custom == ("com.microsoft.Gelu", "their.domain.Boxes")
    inner = onnx.helper.make_graph(
        [onnx.helper.make_node("Hidden", ["x"], ["y"], domain="theirs")], "inner", [], []
    )
    condition = onnx.helper.make_node("If", ["c"], ["z"], then_branch=inner, else_branch=inner)
    content = changed(yolov8(), lambda one: one.graph.node.append(condition))
    assert read_model(write("b.onnx", content)).custom == ("theirs.Hidden",)


def test_texts_of_a_model_need_not_be_utf8(write):
    """Of the same length, so that the file is sound but for that."""
    content = yolov8(metadata={"author": "AAAA"})
    for text in (b"AAAA", b"output0", b"Identity", b"tests"):
        content = content.replace(text, b"\xff" * len(text))
    model = read_model(write("a.onnx", content))
    assert model.metadata["author"] == "\ufffd" * 4 and model.operators["\ufffd" * 8] == 1
    assert model.outputs[0].name == "\ufffd" * 7


def test_weights_in_other_files_are_refused(write):
    def outsource(model):
        tensor = model.graph.initializer[0]
        tensor.data_location = TensorProto.EXTERNAL
        tensor.external_data.add(key="location", value="weights\n.bin")

    path = write("a.onnx", changed(yolov8(), outsource))
    with pytest.raises(
        ValueError, match=r"a.onnx: its weights are in other files \(weights\\n.bin"
    ):
        read_model(path)


@pytest.mark.parametrize("inside", [False, True])
def test_constants_of_nodes_in_other_files_are_refused(write, inside):
    """python3-onnx would read any file for them, such as a device that never ends."""

    def outsource(model):
        tensor = TensorProto(data_type=TensorProto.FLOAT16, dims=[9])
        tensor.data_location = TensorProto.EXTERNAL
        tensor.external_data.add(key="location", value="../dev/zero")
        node = onnx.helper.make_node("Constant", [], ["c"], value=tensor)
        if inside:
            graph = onnx.helper.make_graph([node], "g", [], [])
            node = onnx.helper.make_node("If", ["x"], ["d"], then_branch=graph, else_branch=graph)
        model.graph.node.insert(0, node)

    path = write("a.onnx", changed(yolov8(), outsource))
    with pytest.raises(ValueError, match=r"a.onnx: its weights are in other files \(../dev/zero"):
        read_model(path)


NO_ONNX = "it is damaged, or no ONNX file: "
FOREIGN = [
    ("a.onnx", b"", "it is empty; ONNX"),
    ("a.onnx", bytes(1000), NO_ONNX),
    ("a.onnx", np.random.default_rng(3).bytes(5000), NO_ONNX),
    ("a.onnx", yolov8()[:-100], NO_ONNX),
    ("a.onnx", yolov8() + b"\x04", NO_ONNX),
    ("a.onnx", b"\x08\x07", NO_ONNX + "it has no network"),
    ("a.onnx", b"<html>not found</html>", NO_ONNX),
    (
        "a.pt",
        b"PK\x03\x04 and so on",
        "PyTorch's checkpoints are (.pt): export the network to ONNX",
    ),
    ("a.tflite", b"\x1c\0\0\0TFL3", "it is of TensorFlow Lite: convert it"),
    ("a.h5", b"\x89HDF\r\n\x1a\n and so on", "it is of Keras (HDF5): export"),
    ("a.xml", b"<?xml version='1.0'?><net/>", "an XML file, as OpenVINO's networks are"),
    ("a.jpg", b"\xff\xd8\xff\xe0" * 100, "can be read, and it is none of these"),
    ("a.cfg", "hello", "line 1 is neither [layer] nor key=value: hello"),
    ("a.cfg", "[convolutional]\nfilters=3", "its first section must be [net]"),
    (
        "a.cfg",
        "[net]\nwidth=64\nheight=64\n[maxpool]\nsize=-2",
        "size of [maxpool] is '-2', must be",
    ),
    (
        "a.cfg",
        "[net]\nwidth=64\nheight=64\n[convolutional]\nsize=99",
        "nothing is left of the image in",
    ),
    ("a.cfg", "[net]\nwidth=64\nheight=64\n" + "[x]\n" * 10000, "it has more than 10000 layers"),
    ("a.cfg", DARKNET.replace("mask=0", "mask=1"), "mask of [yolo] is '1', must be some of its 1"),
    ("a.cfg", DARKNET.replace("mask=0", "mask=-5"), "mask of [yolo] is '-5', must be some"),
    ("a.cfg", DARKNET.replace("mask=0", "mask=x"), "mask of [yolo] is 'x', must be some"),
    ("a.cfg", DARKNET.replace("classes=3", "classes=-1"), "classes of [yolo] is '-1', must be"),
    (
        "a.cfg",
        DARKNET.replace("[yolo]", "[upsample]\nstride=1000\n[yolo]"),
        "layer 1, [upsample], gives 512000000 numbers, must give at most",
    ),
    ("a.cfg", "[net]\nwidth=64\n[maxpool]", "[net] must have width, height and channels"),
    ("a.cfg", "[net]\nwidth=64\nheight=64", "it has no layers"),
    (
        "a.cfg",
        "[net]\nwidth=64\nheight=64\n[route]\nlayers=-1",
        "layers of [route] is '-1', must be",
    ),
    ("a.cfg", b"\xff\xfe\0", "line 1 is neither"),
    ("a.cfg", f"[net]\nwidth={'9' * 1000000}\n[maxpool]", "width of [net] is '999"),
    ("a.cfg", "[net]\nwidth=64\nheight=64\n[route]\nlayers=-" + "9" * 1000000, "[route] is '-999"),
    ("a.prototxt", "hello", "it is no network of Caffe: it has no layers"),
    ("a.pbtxt", "hello", "it is no text of a TensorFlow graph: it has no nodes"),
]


@pytest.mark.parametrize("name, content, reason", FOREIGN, ids=list(map(str, range(len(FOREIGN)))))
def test_what_is_no_model_is_told_in_one_line(write, name, content, reason):
    path = write(name, content)
    for suffix, data in ((".weights", darknet_weights()), (".caffemodel", b"a"), (".pb", b"a")):
        write("a" + suffix, data)
    with pytest.raises(ValueError) as error:
        read_model(path)
    assert str(error.value).startswith(f"{path}: ") and reason in str(error.value)
    assert "\n" not in str(error.value)


DAMAGED = {
    "a.onnx": yolov8("segment", ULTRALYTICS),
    "a.cfg": DARKNET.encode(),
    "a.prototxt": CAFFE.encode(),
    "a.pbtxt": TENSORFLOW.encode(),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_what_is_damaged_is_read_or_refused_in_one_line(write, name):
    for suffix, content in ((".weights", darknet_weights()), (".caffemodel", b""), (".pb", b"a")):
        write("a" + suffix, content or CAFFE_MODEL)
    rng = np.random.default_rng(8)
    refused = 0
    for _ in range(150):
        content = bytearray(DAMAGED[name])
        for place in rng.integers(max(0, len(content) - 2000), len(content), rng.integers(1, 6)):
            content[place] = rng.integers(256)
        try:
            input_of(read_model(write(name, bytes(content))))
        except ValueError as error:
            assert "\n" not in str(error)
            refused += 1
    assert 0 < refused < 150


def test_many_spaces_take_no_longer_than_other_letters(write):
    """In a time that grows with their square it would not end."""
    spaces = " " * 1000000
    write("a.caffemodel", CAFFE_MODEL)
    text = f'{CAFFE} layer {{ type: "Input" shape{spaces}}}'
    assert read_model(write("a.prototxt", text)).inputs[0].shape == (1, 3, SIZE, SIZE)
    write("a.pb", b"a")
    text = f'node {{ attr {{ key: "num_classes" value{spaces} }} }}\n{TENSORFLOW}'
    assert read_model(write("a.pbtxt", text)).metadata == {"classes": "90"}


def test_only_regular_files_are_read(tmp_path, write):
    os.mkfifo(tmp_path / "pipe.onnx")
    (tmp_path / "folder.onnx").mkdir()
    write("a.cfg", DARKNET)
    os.mkfifo(tmp_path / "a.weights")
    table = [
        ("none.onnx", "No such file or directory"),
        ("pipe.onnx", "it is no file"),
        ("folder.onnx", "it is no file"),
        ("a.cfg", f"a.weights cannot be read: it is no file (the other file of {tmp_path}/a.cfg)"),
    ]
    for name, reason in table:
        with pytest.raises(OSError) as error:
            read_model(str(tmp_path / name))
        assert reason in str(error.value)


def test_darknet_is_read_from_either_of_its_files(write, tmp_path):
    text, weights = write("a.cfg", DARKNET), write("a.weights", darknet_weights())
    for path in (text, weights):
        model = read_model(path)
        assert (model.kind, model.description) == ("darknet", DARKNET.encode())
        assert model.data == darknet_weights() and model.metadata == {"classes": "3"}
        assert str(model.inputs[0]) == "data 1x3x64x64 float32"
        assert model.parameters == 8 + 8 * 3 * 64
    elsewhere = write("other.weights", darknet_weights())
    os.remove(weights)
    assert read_model(text, elsewhere).data == darknet_weights()
    with pytest.raises(OSError, match=r"No such file or directory \(the other file of"):
        read_model(text)


# The number of weights of each layer is derived here, layer by layer, of an input of 3x8x8.
LAYERS = [
    ("[convolutional]\nfilters=4\nsize=5\npad=1\nbatch_normalize=1", 4 * 75 + 4 * 4),
    ("[maxpool]\nsize=2\nstride=2", 0),  # 4x4x4
    ("[upsample]\nstride=2", 0),  # 4x8x8
    ("[route]\nlayers=-1,0", 0),  # 8x8x8
    ("[convolutional]\nfilters=6\nsize=1\ngroups=2", 6 * 4 + 6),
    ("[shortcut]\nfrom=-1", 0),
    ("[route]\nlayers=-1\ngroups=2\ngroup_id=1", 0),  # 3x8x8
    ("[reorg]\nstride=2", 0),  # 12x4x4
    ("[connected]\noutput=5", 5 * 192 + 5),
    ("[yolo]\nclasses=2", 0),
]


@pytest.mark.parametrize("missing, extra", [(0, 0), (1, 0), (0, 1)])
def test_the_weights_of_darknet_are_counted(write, missing, extra):
    """OpenCV would run a network with too few, and compute with what is in memory instead."""
    text = "[net]\nwidth=8\nheight=8\nchannels=3\n" + "\n".join(layer for layer, _ in LAYERS)
    count = sum(number for _, number in LAYERS)
    content = struct.pack("<iiiq", 0, 2, 5, 1) + bytes(4 * count - missing) + bytes(extra)
    write("a.weights", content)
    path = write("a.cfg", text)
    if missing:
        with pytest.raises(
            ValueError, match=f"have {len(content)} bytes, must have {20 + 4 * count}"
        ):
            read_model(path)
        return
    model = read_model(path)
    assert model.parameters == count
    assert [f"only {20 + 4 * count} belong" in one for one in model.warnings] == [True] * extra


def test_an_unknown_layer_of_darknet_leaves_the_weights_uncounted(write):
    write("a.weights", b"few")
    model = read_model(write("a.cfg", DARKNET + "[capsule]\nsize=1\n"))
    assert model.parameters is None and model.operators["capsule"] == 1


def test_caffe_says_its_input_in_three_ways(write):
    write("a.caffemodel", CAFFE_MODEL)
    shape = "input_shape { dim: 1 dim: 3 dim: 64 dim: 64 }"
    old = "input_dim: 1 input_dim: 3 # input_dim: 7\n input_dim: 64 input_dim: 64"
    layer = 'layer { name: "data" type: "Input" top: "data" input_param { SHAPE } }'
    layer = layer.replace("SHAPE", shape.replace("input_shape", "shape:"))
    for text in (CAFFE, CAFFE.replace(shape, old), CAFFE.replace('input: "data"\n' + shape, layer)):
        model = read_model(write("a.prototxt", text))
        assert str(model.inputs[0]) == "data 1x3x64x64 float32"
        assert model.metadata == {"classes": "2"}  # the first of three is no object
        assert model.operators["DetectionOutput"] == 1
    write("b.caffemodel", b"")
    with pytest.raises(ValueError, match=r"b\.caffemodel: it is empty"):
        read_model(write("b.prototxt", CAFFE))
    none = read_model(write("a.prototxt", CAFFE.replace(shape, "")))
    assert none.inputs[0].shape == (1, 3, None, None)


def test_tensorflow_says_its_input_with_the_channels_last(write):
    write("a.pb", b"weights")
    model = read_model(write("a.pbtxt", TENSORFLOW))
    assert str(model.inputs[0]) == "picture 1x3x240x320 float32"
    assert model.metadata == {"classes": "90"} and model.data == b"weights"
    assert model.operators == {"Placeholder": 1, "DetectionOutput": 1}


SHAPES = [
    ((1, 3, 48, 64), {}, (64, 48, "nchw")),
    ((1, 48, 64, 3), {}, (64, 48, "nhwc")),
    ((1, 3, None, None), {"width": 96, "height": 32}, (96, 32, "nchw")),
    ((None, None, None, None), {"width": 96, "height": 32}, (96, 32, "nchw")),
    ((1, 3, None, 64), {"height": 32}, (64, 32, "nchw")),
    ((1, 3, 48, 64), {"width": 64}, (64, 48, "nchw")),
]


def with_input(*shapes, kind=TensorProto.FLOAT, metadata=()):
    def change(model):
        del model.graph.input[:]
        for number, shape in enumerate(shapes):
            sides = ["open" if side is None else side for side in shape]
            value = onnx.helper.make_tensor_value_info(f"input{number}", kind, sides)
            model.graph.input.append(value)

    return changed(yolov8(metadata=metadata), change)


@pytest.mark.parametrize("shape, wanted, expected", SHAPES)
def test_the_input_is_found(write, shape, wanted, expected):
    model = read_model(write("a.onnx", with_input(shape)))
    found = input_of(model, **wanted)
    assert (found.width, found.height, found.layout) == expected
    channels_last = expected[2] == "nhwc"
    height, width = expected[1], expected[0]
    assert found.shape == ((1, height, width, 3) if channels_last else (1, 3, height, width))


def test_open_sizes_are_those_of_the_metadata(write):
    content = with_input((1, 3, None, None), metadata={"imgsz": "[480, 640]"})
    found = input_of(read_model(write("a.onnx", content)))
    assert (found.width, found.height) == (640, 480)
    for text in ("[480]", "640.5", "[0, 3]", "[[1], 2]", "{", "['a', 'b']", "!!python/none"):
        content = with_input((1, 3, None, None), metadata={"imgsz": text})
        with pytest.raises(ValueError, match="no fixed size: set input_width, in pixels"):
            input_of(read_model(write("a.onnx", content)))


BAD_INPUTS = [
    ([(1, 1, 64, 64)], {}, "input0 1x1x64x64 takes 1 channels, must take 3, the colours"),
    ([(1, 64, 64, 4)], {}, "takes 4 channels, must take 3"),
    ([(1, 3, 64)], {}, "must have four axes"),
    ([], {}, r"it has 0 inputs \(none\), must have one, an image"),
    ([(1, 3, 64, 64), (1, 2)], {}, r"2 inputs \(input0 1x3x64x64 float32, input1 1x2 float32\)"),
    ([(4, 3, 64, 64)], {}, "takes 4 images, must take one"),
    ([(1, 3, 64, 64)], {"width": 32}, "input_width is 32, must be 0 or 64"),
    ([(1, 3, None, 64)], {}, "no fixed size: set input_height"),
    ([(1, 3, 100000, 64)], {}, "the height of its input is 100000, must be from 1 to 4096"),
    ([(1, 3, 64, 64)], {"kind": TensorProto.INT64}, "int64 must be of float32, float16, uint8"),
]


@pytest.mark.parametrize("shapes, wanted, reason", BAD_INPUTS)
def test_an_input_that_is_no_image_is_refused(write, shapes, wanted, reason):
    kind = wanted.pop("kind", TensorProto.FLOAT)
    model = read_model(write("a.onnx", with_input(*shapes, kind=kind)))
    with pytest.raises(ValueError, match=reason):
        input_of(model, **wanted)


def test_a_constant_that_old_files_list_as_an_input_is_none(write):
    """Before its fourth version ONNX wanted all weights among the inputs."""

    def list_weights(model):
        for one in model.graph.initializer:
            value = onnx.helper.make_tensor_value_info(one.name, one.data_type, list(one.dims))
            model.graph.input.append(value)

    model = read_model(write("a.onnx", changed(networks.yolov10(), list_weights)))
    assert [one.name for one in model.inputs] == ["images"]
