"""Both runtimes compute what the network says, and tell what they cannot do."""

import os
import pathlib
import subprocess
import sys
import threading

import cv2
import numpy as np
import onnx
import pytest
from network_files import CAFFE, CAFFE_MODEL, DARKNET, darknet_weights
from network_graph import CLASSES, SIZE, Graph
from networks import yolov8
from onnx import TensorProto
from runtime_cases import BACKENDS, BACKENDS_OF_HEADS, needs_newer_opencv, needs_onnxruntime

from robot_vision.dnn import onnx_runtime, runtimes
from robot_vision.dnn.model_file import read_model
from robot_vision.dnn.network import NetworkSettings, first_run, open_network
from robot_vision.dnn.network_input import input_of
from robot_vision.dnn.onnx_rewrite import plain_onnx
from robot_vision.dnn.runtimes import NetworkError, advice_for, make_runtime


@pytest.fixture
def opened(tmp_path):
    """opened(content, backend, ...) gives the model, its input and its runtime."""

    def made(content, backend="auto", width=0, height=0, **options):
        path = tmp_path / "a.onnx"
        path.write_bytes(content)
        model = read_model(str(path))
        network_input = input_of(model, width, height)
        return model, network_input, make_runtime(model, network_input, backend, **options)

    return made


def scores_graph(**options):
    graph = Graph(**options)
    graph.output(graph.scores([8]), "scores", [1, CLASSES, "cells"])
    return graph.bytes()


def means(values):
    """The scores of a network of scores_graph(), of each channel in each cell."""
    _, channels, height, width = values.shape
    cells = values.reshape(channels, height // 8, 8, width // 8, 8).astype(np.float64)
    return cells.mean(axis=(2, 4)).reshape(1, channels, -1)


def random_input(network_input):
    return np.random.default_rng(5).random(network_input.shape, np.float32)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_network_computes_what_it_says(opened, backend):
    _, network_input, runtime = opened(scores_graph(), backend)
    assert runtime.name == {"opencv": "OpenCV"}.get(backend, backend)
    values = random_input(network_input)
    before = values.copy()
    (scores,) = runtime.run(values)
    assert scores.dtype == np.float32 and scores.flags.c_contiguous
    np.testing.assert_allclose(scores, means(values), atol=1e-6)
    np.testing.assert_array_equal(values, before)
    (again,) = runtime.run(np.zeros_like(values))
    assert not again.any() and scores.any()  # what was given out stays as it was


@pytest.mark.parametrize("backend", BACKENDS_OF_HEADS)
def test_outputs_come_in_the_order_of_the_file(opened, backend):
    _, network_input, runtime = opened(yolov8("segment"), backend)
    shapes = [one.shape for one in runtime.run(random_input(network_input))]
    assert shapes == [(1, 4 + CLASSES + 32, 84), (1, 32, 16, 16)]
    assert list(runtime.output_names) == ["output0", "output1"]


@pytest.mark.parametrize("backend", BACKENDS)
def test_open_sizes_are_filled(opened, backend):
    content = scores_graph(shape=("batch", 3, "height", "width"))
    _, network_input, runtime = opened(content, backend, width=96, height=32)
    values = random_input(network_input)
    assert values.shape == (1, 3, 32, 96)
    (scores,) = runtime.run(values)
    np.testing.assert_allclose(scores, means(values), atol=1e-6)


@pytest.mark.parametrize("backend", BACKENDS)
def test_half_precision_is_converted(opened, backend):
    graph = Graph(kind=TensorProto.FLOAT16)
    scores = graph.node("Cast", graph.scores([8]), to=TensorProto.FLOAT16)
    graph.output(scores, "scores", [1, CLASSES, 64])
    model, network_input, runtime = opened(graph.bytes(), backend)
    assert model.half and network_input.type == "float16"
    values = random_input(network_input)
    (scores,) = runtime.run(values)
    assert scores.dtype == np.float32
    np.testing.assert_allclose(scores, means(values), atol=2e-3)


def test_what_opencv_gets_has_no_half_precision_and_no_open_sizes():
    graph = Graph(("batch", 3, "height", "width"), TensorProto.FLOAT16)
    wide = graph.node("Cast", graph.scores([8]), to=TensorProto.FLOAT)
    graph.output(graph.node("Cast", wide, to=TensorProto.FLOAT16), "scores", ["b", CLASSES, "n"])
    model = onnx.ModelProto.FromString(graph.bytes())
    stale = onnx.helper.make_tensor_value_info(wide, TensorProto.FLOAT, [9, 9, 9])
    model.graph.value_info.append(stale)
    plain = onnx.ModelProto.FromString(plain_onnx(model.SerializeToString(), (1, 3, 32, 96)))
    inferred = onnx.shape_inference.infer_shapes(plain).graph
    values = [*inferred.input, *inferred.value_info, *inferred.output]
    assert {one.type.tensor_type.elem_type for one in values} == {TensorProto.FLOAT}
    assert [side.dim_value for side in inferred.input[0].type.tensor_type.shape.dim] == [
        1,
        3,
        32,
        96,
    ]
    (shape,) = (one.type.tensor_type.shape for one in inferred.value_info if one.name == wide)
    assert [side.dim_value for side in shape.dim][:2] == [1, CLASSES]  # old versions have no third


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_constant_may_have_several_names(opened, backend):
    """As PyTorch writes it for weights that are equal."""
    model = onnx.ModelProto.FromString(scores_graph())
    (convolution,) = (node for node in model.graph.node if node.op_type == "Conv")
    name = convolution.input[1]
    for number, (source, other) in enumerate(((name, "one"), ("one", "another"))):
        model.graph.node.insert(number, onnx.helper.make_node("Identity", [source], [other]))
    convolution.input[1] = "another"
    _, network_input, runtime = opened(model.SerializeToString(), backend)
    values = random_input(network_input)
    np.testing.assert_allclose(runtime.run(values)[0], means(values), atol=1e-6)


def bytes_graph():
    """A network of bytes, which it makes numbers of by itself."""
    model = onnx.ModelProto.FromString(scores_graph())
    model.graph.input[0].type.tensor_type.elem_type = TensorProto.UINT8
    for node in model.graph.node:
        node.input[:] = ["numbers" if name == "images" else name for name in node.input]
    cast = onnx.helper.make_node("Cast", ["images"], ["numbers"], to=TensorProto.FLOAT)
    model.graph.node.insert(0, cast)
    return model.SerializeToString()


@pytest.mark.parametrize("backend", BACKENDS)
def test_bytes_are_rounded(opened, backend):
    _, network_input, runtime = opened(bytes_graph(), backend)
    assert network_input.type == "uint8"
    (scores,) = runtime.run(np.full(network_input.shape, 200.6, np.float32))
    assert (scores == 201.0).all()
    (scores,) = runtime.run(np.full(network_input.shape, 300.0, np.float32))
    assert (scores == 255.0).all()


def test_darknet_and_caffe_are_opencvs(tmp_path):
    (tmp_path / "a.cfg").write_text(DARKNET)
    (tmp_path / "a.weights").write_bytes(darknet_weights())
    (tmp_path / "b.prototxt").write_text(CAFFE)
    (tmp_path / "b.caffemodel").write_bytes(CAFFE_MODEL)
    for name, shape in (("a.cfg", (64, 5 + CLASSES)), ("b.prototxt", (1, 1, 100, 7))):
        model = read_model(str(tmp_path / name))
        network_input = input_of(model)
        runtime = make_runtime(model, network_input)
        assert runtime.name == "OpenCV" and not advice_for(model, runtime)
        outputs = runtime.run(np.zeros(network_input.shape, np.float32))
        assert [one.shape for one in outputs] == [shape]
        with pytest.raises(ValueError, match=f"which runs ONNX only, and not {model.kind}"):
            make_runtime(model, network_input, "onnxruntime")


@needs_newer_opencv
def test_weights_that_are_none_are_told(tmp_path, capfd):
    for name, text in (("a.prototxt", CAFFE), ("a.pbtxt", 'node { name: "a" op: "Placeholder" }')):
        (tmp_path / name).write_text(text)
    for suffix in (".caffemodel", ".pb"):
        (tmp_path / ("a" + suffix)).write_bytes(b"\xff" * 100)
    for name in ("a.prototxt", "a.pbtxt"):
        model = read_model(str(tmp_path / name))
        settings = NetworkSettings(str(tmp_path / name), input_width=64, input_height=64)
        with pytest.raises(ValueError, match="OpenCV ") as error:  # some versions only run it
            open_network(settings, model)
        assert "\n" not in str(error.value) and str(error.value).startswith(f"{model.path}: ")


@pytest.mark.parametrize("backend", ["auto", *BACKENDS])
def test_operators_of_others_are_named(opened, backend):
    graph = Graph()
    graph.output(graph.custom("Boxes", "their.domain", graph.scores()), "output", [1, 3, 84])
    with pytest.raises(ValueError, match=r"no runtime here has: their.domain.Boxes; export it"):
        opened(graph.bytes(), backend)


@needs_onnxruntime
def test_what_no_runtime_can_read_has_the_reasons_of_both(opened, capfd):
    graph = Graph()
    graph.output(graph.node("Unheard", graph.scores()), "output", [1, 3, 84])
    with pytest.raises(ValueError) as error:
        opened(graph.bytes())
    assert "OpenCV cannot read it: " in str(error.value) and "\n" not in str(error.value)
    assert "onnxruntime cannot read it: " in str(error.value) and "Unheard" in str(error.value)
    with pytest.raises(ValueError, match=r"^OpenCV cannot read it: ") as error:
        opened(graph.bytes(), "opencv")
    assert capfd.readouterr() == ("", "")


def test_an_input_of_another_shape_or_type_is_refused(opened):
    _, _, runtime = opened(scores_graph())
    for values in (
        np.zeros((1, 3, SIZE, SIZE)),
        np.zeros((1, 3, SIZE, SIZE), np.uint8),
        np.zeros((1, 3, SIZE, 32), np.float32),
        np.zeros((0,), np.float32),
    ):
        with pytest.raises(ValueError, match=r"must be float32 of shape .1, 3, 64, 64."):
            runtime.run(values)


@needs_onnxruntime
def test_onnxruntime_that_throws_in_mid_stream_is_no_bad_start(opened):
    """The number that the image gives is looked up in a table of one."""
    graph = Graph()
    highest = graph.node("ReduceMax", "images", keepdims=0)
    number = graph.node("Cast", highest, to=TensorProto.INT64)
    table = graph.constant(np.float32([7.0]))
    graph.output(graph.node("Gather", table, number, axis=0), "output", [])
    _, network_input, runtime = opened(graph.bytes(), "onnxruntime")
    values = np.zeros(network_input.shape, np.float32)
    assert runtime.run(values)[0] == 7.0
    with pytest.raises(NetworkError, match=r"^onnxruntime failed: ") as error:
        runtime.run(values + 3.0)
    assert "\n" not in str(error.value)
    assert runtime.run(values)[0] == 7.0  # and the next image is one like any other


def test_opencv_that_throws_in_mid_stream_is_no_bad_start(opened):
    _, network_input, runtime = opened(scores_graph(), "opencv")
    net = runtime._net

    class Broken:
        def setInput(self, _values):  # noqa: N802
            cv2.resize(np.zeros((1, 1)), (0, 0))

    runtime._net = Broken()
    with pytest.raises(NetworkError, match=r"^OpenCV failed: "):
        runtime.run(np.zeros(network_input.shape, np.float32))
    runtime._net = net
    assert len(runtime.run(np.zeros(network_input.shape, np.float32))) == 1


@pytest.mark.parametrize("output", [{0: 0.5}, ["cat"], [[1.0], [2.0, 3.0]]])
def test_outputs_that_are_no_numbers_are_no_bad_start(opened, output):
    """As sklearn's converters give them: a map for each image, or names."""
    _, network_input, runtime = opened(scores_graph())
    runtime._forward = lambda values: [output]
    with pytest.raises(NetworkError, match=f"^{runtime.name} failed: "):
        runtime.run(np.zeros(network_input.shape, np.float32))


def test_an_identity_without_outputs_changes_nothing():
    graph = Graph()
    constant = graph.constant(np.float32([1.0]))
    graph.output(graph.node("Add", "images", constant), "output", [1, 3, SIZE, SIZE])
    model = onnx.ModelProto.FromString(graph.bytes())
    model.graph.node.add(op_type="Identity", input=[constant])
    before = [node.op_type for node in model.graph.node]
    plain = onnx.ModelProto.FromString(plain_onnx(model.SerializeToString(), (1, 3, SIZE, SIZE)))
    assert [node.op_type for node in plain.graph.node] == before


def test_without_onnxruntime_opencv_runs_all_and_says_what_is_faster(opened, monkeypatch):
    for module in (runtimes, onnx_runtime):
        monkeypatch.setattr(module, "find_onnxruntime", lambda: (None, "it is not there"))
    model, network_input, runtime = opened(scores_graph())
    assert runtime.name == "OpenCV"
    advice = advice_for(model, runtime)
    assert (
        advice.startswith("OpenCV runs it, as it is not there; ") and "make onnxruntime" in advice
    )
    values = random_input(network_input)
    np.testing.assert_allclose(runtime.run(values)[0], means(values), atol=1e-6)
    with pytest.raises(ValueError, match=r"^it is not there; .*`make onnxruntime`"):
        opened(scores_graph(), "onnxruntime")


def test_unknown_backends_and_processors_are_refused(opened):
    with pytest.raises(ValueError, match="backend is cuda, must be auto, onnxruntime, opencv"):
        opened(scores_graph(), "cuda")
    with pytest.raises(ValueError, match=r"affinity has the processors \[9999\], must be some of"):
        opened(scores_graph(), affinity=[9999])


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_network_stays_on_its_processors(opened, backend):
    before = os.sched_getaffinity(0)
    chosen = {max(before)}
    _, network_input, runtime = opened(scores_graph(), backend, affinity=sorted(chosen))
    assert os.sched_getaffinity(0) == before
    seen = []

    def run():
        runtime.run(np.zeros(network_input.shape, np.float32))
        seen.append(os.sched_getaffinity(0))

    first_run(runtime, network_input)  # of the thread that starts all others of a node
    assert os.sched_getaffinity(0) == before
    for _ in range(2):  # the second thread often has the number of the first, which has ended
        thread = threading.Thread(target=run)
        thread.start()
        thread.join()
    assert seen == [chosen, chosen] and os.sched_getaffinity(0) == before


@needs_onnxruntime
@pytest.mark.parametrize("threads", [1, 2])
def test_onnxruntime_has_as_many_threads_as_it_is_told(opened, threads):
    _, _, runtime = opened(scores_graph(), "onnxruntime", threads=threads)
    assert runtime._session.get_session_options().intra_op_num_threads == threads


@needs_onnxruntime
@pytest.mark.parametrize("threads", [0, 2])
def test_the_threads_of_onnxruntime_stay_on_its_processors(opened, threads):
    chosen = {min(os.sched_getaffinity(0))}
    before = os.listdir("/proc/self/task")
    _, _, runtime = opened(scores_graph(), "onnxruntime", threads=threads, affinity=sorted(chosen))
    others = set(os.listdir("/proc/self/task")) - set(before)
    assert [os.sched_getaffinity(int(one)) for one in others] == [chosen] * max(0, threads - 1)
    assert runtime._session.get_session_options().intra_op_num_threads == (threads or 1)


def found_in(folder, tmp_path):
    """What a new process finds if only this folder may have onnxruntime, and its sys.path then."""
    program = (
        "import sys; from robot_vision.dnn.onnxruntime_folder import find_onnxruntime;"
        "found = find_onnxruntime(); import numpy;"
        "print(found[0] and found[0].__file__, found[1], numpy.__file__, sys.path[-1], sep='\\n')"
    )
    env = {**os.environ, "HOME": str(tmp_path), "ROS_HOME": str(tmp_path / "ros")}
    env["ROBOT_VISION_ONNXRUNTIME"] = str(folder)
    command = [sys.executable, "-c", program]
    return subprocess.run(command, env=env, check=True, stdout=subprocess.PIPE, text=True).stdout


@pytest.fixture
def packages(tmp_path):
    """A folder as `make onnxruntime` makes it, with another onnxruntime and another NumPy."""
    python = f"python{sys.version_info[0]}.{sys.version_info[1]}"
    folder = tmp_path / "own" / "lib" / python / "site-packages"
    for name in ("onnxruntime", "numpy"):
        (folder / name).mkdir(parents=True)
        (folder / name / "__init__.py").write_text("here = True\n")
    return folder


def test_onnxruntime_is_found_in_its_folder_and_numpy_is_not(tmp_path, packages):
    path, reason, numpy, last = found_in(tmp_path / "own", tmp_path).splitlines()
    if path != str(packages / "onnxruntime" / "__init__.py"):
        pytest.skip("this system has onnxruntime itself")
    assert reason == "" and last == str(packages)
    assert numpy == np.__file__


def test_an_onnxruntime_that_cannot_be_imported_is_told(tmp_path, packages):
    (packages / "onnxruntime" / "__init__.py").write_text("raise SystemError('of another\\nNumPy')")
    path, reason, _, last = found_in(tmp_path / "own", tmp_path).splitlines()
    if path != "None":
        pytest.skip("this system has onnxruntime itself")
    assert reason == f"onnxruntime of {packages} cannot be imported: of another NumPy"
    assert last != str(packages)


def test_the_installer_replaces_nothing_but_its_own(tmp_path):
    (tmp_path / "mine").write_text("here")
    installer = pathlib.Path(__file__).parents[2] / "tools" / "onnxruntime"
    run = subprocess.run([str(installer), str(tmp_path)], stderr=subprocess.PIPE, text=True)
    assert run.returncode == 1 and (tmp_path / "mine").read_text() == "here"
    assert run.stderr == f"robot_vision: {tmp_path} is there already, and holds something else\n"


def test_without_any_onnxruntime_that_is_the_reason(tmp_path):
    path, reason, _, _ = found_in(tmp_path / "nowhere", tmp_path).splitlines()
    if path != "None":
        pytest.skip("this system has onnxruntime itself")
    assert reason == "onnxruntime is not installed"
