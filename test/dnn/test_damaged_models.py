"""Models that no runtime would survive, or that take more than any is worth, are refused."""

import numpy as np
import onnx
import pytest
from network_files import CAFFE, CAFFE_MODEL
from network_graph import Graph
from networks import ULTRALYTICS, yolov8
from onnx import TensorProto
from runtime_cases import needs_onnxruntime

from robot_vision.dnn.heads import guess_head
from robot_vision.dnn.model_file import read_model
from robot_vision.dnn.network import NetworkSettings, open_network
from robot_vision.dnn.network_input import NetworkInput, input_of


@pytest.fixture
def refusal(tmp_path):
    """refusal(change, backend) gives the one line that says why a changed model is refused."""

    def of(change, backend="opencv"):
        model = onnx.ModelProto()
        model.ParseFromString(yolov8(metadata=ULTRALYTICS))
        change(model)
        path = tmp_path / "a.onnx"
        path.write_bytes(model.SerializeToString())
        with pytest.raises(ValueError) as error:
            open_network(NetworkSettings(str(path), backend=backend))
        text = str(error.value)
        assert text.startswith(f"{path}: ") and text.isprintable() and len(text) < 1000
        return text

    return of


def weights_of(model):
    return model.graph.initializer[1]


def node_of(model, operator):
    return next(node for node in model.graph.node if node.op_type == operator)


@pytest.mark.parametrize("dims", [[1 << 40, 3], [-1], [1 << 62] * 100, [3, 3, 8, 9]], ids=len)
def test_a_constant_has_as_many_values_as_its_sides_say(refusal, dims):
    def change(model):
        del weights_of(model).dims[:]
        weights_of(model).dims.extend(dims)

    assert "its constant constant_1 " in refusal(change)


def test_values_that_are_not_raw_are_counted_too(refusal):
    def change(model):
        weights_of(model).ClearField("raw_data")
        weights_of(model).float_data.extend([0.5] * 7)

    assert "its constant constant_1 has 7 values, must have 576" in refusal(change)
    assert "has 0 values" in refusal(lambda model: weights_of(model).ClearField("raw_data"))


@pytest.mark.parametrize("place", ["/etc/passwd", "../../secret", "\x1b[2J"])
def test_constants_of_nodes_are_in_the_model_itself_as_well(refusal, place):
    """Rewriting them for OpenCV would open the file, whatever it is."""

    def change(model):
        constant = model.graph.node.add(op_type="Constant", name="secret", output=["unused"])
        attribute = constant.attribute.add(name="value", type=onnx.AttributeProto.TENSOR)
        attribute.t.data_type = TensorProto.FLOAT16
        attribute.t.dims.append(4)
        attribute.t.data_location = TensorProto.EXTERNAL
        attribute.t.external_data.add(key="location", value=place)

    assert "its weights are in other files" in refusal(change)


@pytest.mark.parametrize("name", ["x", "output0", "\x1b[2J"])
def test_what_nothing_gives_is_not_looked_for_in_memory(refusal, name):
    def change(model):
        node_of(model, "Conv").input[1] = name

    assert "which nothing before it gives" in refusal(change)


def test_a_convolution_by_nothing_is_refused(refusal):
    """As it would be divided by that, which ends the process."""

    def empty(model):
        weights_of(model).dims[0] = 0
        weights_of(model).raw_data = b""

    assert "its node conv_0 (Conv) takes a constant that is empty" in refusal(empty)
    for name, value in (("group", 0), ("strides", [8, 0]), ("dilations", [1 << 40, 1])):

        def change(model, name=name, value=value):
            node = node_of(model, "Conv")
            kept = [one for one in node.attribute if one.name != name]
            del node.attribute[:]
            node.attribute.extend([*kept, onnx.helper.make_attribute(name, value)])

        assert f"{name} of its convolution conv_0 is " in refusal(change)


def empty_weights_of_a_node(_):
    empty = onnx.numpy_helper.from_array(np.zeros((0, 3, 8, 8), np.float32))
    return onnx.helper.make_node("Constant", [], ["other"], value=empty)


def empty_weights_by_another_name(model):
    weights_of(model).dims[0] = 0
    weights_of(model).raw_data = b""
    return onnx.helper.make_node("Identity", [weights_of(model).name], ["other"])


@pytest.mark.parametrize("source", [empty_weights_of_a_node, empty_weights_by_another_name])
def test_a_convolution_by_nothing_is_refused_wherever_that_is_from(refusal, source):
    def change(model):
        node_of(model, "Conv").input[1] = "other"
        nodes = [source(model), *model.graph.node]
        del model.graph.node[:]
        model.graph.node.extend(nodes)

    assert "its node conv_0 (Conv) takes a constant that is empty" in refusal(change)


def node_before_others(model, operator, *inputs, **attributes):
    node = onnx.helper.make_node(operator, inputs, [f"{operator}_of_it"], operator, **attributes)
    nodes = [node, *model.graph.node]
    del model.graph.node[:]
    model.graph.node.extend(nodes)
    return node.output[0]


def add_constant(model, name, values):
    model.graph.initializer.append(onnx.numpy_helper.from_array(np.asarray(values), name))
    return name


@pytest.mark.parametrize(
    "shape, operator, others, attributes",
    [
        ((0, 3, 8, 8), "Concat", ["constant_1"], {"axis": 0}),
        ((1, 0), "Squeeze", [], {"axes": [0]}),
        ((0,), "Gather", ["first"], {}),
        ((0,), "Gemm", ["empty"], {}),
        ((0,), "Mul", ["empty"], {}),
        ((0,), "DequantizeLinear", ["empty", "empty"], {}),
    ],
)
def test_no_node_works_on_nothing(refusal, shape, operator, others, attributes):
    def change(model):
        add_constant(model, "first", [0])
        empty = add_constant(model, "empty", np.zeros(shape, np.float32))
        node_before_others(model, operator, empty, *others, **attributes)

    said = f"its node {operator} ({operator}) takes a constant that is empty"
    assert said in refusal(change)


def test_nothing_of_another_type_is_nothing(refusal):
    def change(model):
        empty = add_constant(model, "empty", np.zeros(0, np.float32))
        node_before_others(model, "Concat", "Cast_of_it", "constant_1", axis=0)
        node_before_others(model, "Cast", empty, to=TensorProto.INT64)

    assert "its node Concat (Concat) takes a constant that is empty" in refusal(change)


def test_a_setting_may_be_empty(tmp_path):
    """Exporters write such a one where the regions of a Resize are not given."""
    model = onnx.ModelProto()
    model.ParseFromString(yolov8(metadata=ULTRALYTICS))
    scales = add_constant(model, "scales", np.array([1.0, 1.0, 2.0, 2.0], np.float32))
    modes = {"mode": "nearest", "coordinate_transformation_mode": "asymmetric"}
    node_before_others(model, "Resize", "images", "Identity_of_it", scales, **modes)
    node_before_others(model, "Identity", add_constant(model, "empty", np.zeros(0, np.float32)))
    path = tmp_path / "a.onnx"
    path.write_bytes(model.SerializeToString())
    assert open_network(NetworkSettings(str(path), backend="opencv")).head.head == "yolov8"


def test_an_output_that_nothing_gives_is_told(refusal):
    def change(model):
        model.graph.output[0].name = "other"

    assert "its output other is what no node gives" in refusal(change)


def test_of_very_many_inputs_outputs_and_operators_the_first_are_told(refusal):
    def inputs(model):
        for number in range(10000):
            model.graph.input.add().CopyFrom(model.graph.input[0])
            model.graph.input[-1].name = f"input_{number}"

    def custom(model):
        for number in range(10000):
            model.graph.node.add(domain="theirs", op_type=f"Operator{number}")

    assert "and 9993 more" in refusal(inputs)
    assert "and 9992 more" in refusal(custom)

    def sides(model):
        shape = model.graph.input[0].type.tensor_type.shape
        for _ in range(10000):
            shape.dim.add().dim_value = 3

    assert "x..." in refusal(sides)


def test_more_classes_than_anybody_has_names_for_are_refused(tmp_path):
    path = tmp_path / "a.onnx"
    path.write_bytes(yolov8())
    image = NetworkInput("images", 8, 8, "nchw", "float32")
    with pytest.raises(ValueError, match="it has 99996 classes as yolov8, must have at most 10000"):
        guess_head(read_model(str(path)), image, [(1, 100000, 1)])


@needs_onnxruntime
def test_outputs_that_are_no_numbers_are_told(tmp_path):
    graph = Graph()
    graph.output(graph.scores([8]), "output0", [1, 3, 64])
    graph.output(graph.constant(np.array(["a\nb"], object)), "output1", [1])
    model = onnx.ModelProto()
    model.ParseFromString(graph.bytes())
    model.graph.output[1].type.tensor_type.elem_type = TensorProto.STRING
    path = tmp_path / "a.onnx"
    path.write_bytes(model.SerializeToString())
    with pytest.raises(ValueError, match=r"onnxruntime failed: .*, with a first image of zeros"):
        open_network(NetworkSettings(str(path), backend="onnxruntime"))


SPACES = " " * (1 << 20)


@pytest.mark.parametrize(
    "text",
    [
        'layer { type: "Input" ' * 50000,
        f"layer {{ input_shape{SPACES}",
        f'layer {{ "Input" shape{SPACES}',
    ],
    ids=["inputs", "shape", "layer"],
)
def test_texts_are_read_in_linear_time(tmp_path, text):
    """In another they would take days, and more memory than there is."""
    (tmp_path / "a.prototxt").write_text(text)
    (tmp_path / "a.caffemodel").write_bytes(CAFFE_MODEL)
    assert read_model(str(tmp_path / "a.prototxt")).inputs[0].shape == (1, 3, None, None)
    (tmp_path / "a.pbtxt").write_text(f'node {{ "num_classes" value{SPACES}')
    (tmp_path / "a.pb").write_bytes(b"x")
    assert read_model(str(tmp_path / "a.pbtxt")).metadata == {}


def test_a_layer_says_the_input_of_caffe_behind_its_name(tmp_path):
    layer = 'layer { name: "data" type: "Input" top: "data"\n input_param { shape: { dim: 1 dim: 3'
    text = CAFFE.replace(CAFFE.splitlines()[1], "").replace(CAFFE.splitlines()[2], "")
    (tmp_path / "a.prototxt").write_text(f"{layer} dim: 32 dim: 64 }} }} }}\n{text}")
    (tmp_path / "a.caffemodel").write_bytes(CAFFE_MODEL)
    found = input_of(read_model(str(tmp_path / "a.prototxt")))
    assert (found.width, found.height) == (64, 32)
    assert np.prod(found.shape) == 3 * 32 * 64


def test_names_that_are_no_text_are_told(tmp_path):
    path = tmp_path / "a.onnx"
    path.write_bytes(yolov8().replace(b"constant_1", b"constant_\xff", 1))
    with pytest.raises(ValueError, match=r"\(Conv\) takes constant_., which nothing before it"):
        open_network(NetworkSettings(str(path), backend="opencv"))
