"""ONNX models as OpenCV can read them.

It wants numbers of 32 bits, the sizes of the input, and constants by their own names: PyTorch
writes weights that are equal only once, and an Identity of them for each other use.
"""

from typing import Any, Dict, Sequence

from .model_facts import ModelFile
from .onnx_file import FLOAT, FLOAT16, load_onnx, parse
from .onnx_graph import nodes_of


def needs_rewriting(model: ModelFile) -> bool:
    """Returns whether an ONNX model may have something that OpenCV cannot read."""
    return model.half or model.dynamic or not {"Cast", "Identity"}.isdisjoint(model.operators)


def opencv_onnx(content: bytes, shape: Sequence[int]) -> bytes:
    """Returns what plain_onnx() does, without conversions to float: to OpenCV all is that.

    Raises:
        ValueError: It is no ONNX model.
    """
    model = parse(plain_onnx(content, shape), "it is no ONNX file")
    for node in nodes_of(model.graph):  # Before 4.3 it has no Cast.
        if node.op_type == "Cast" and any(one.i == FLOAT for one in node.attribute):
            node.op_type = "Identity"
            del node.attribute[:]
    return model.SerializeToString()


def plain_onnx(content: bytes, shape: Sequence[int]) -> bytes:
    """Returns an ONNX model with an input of this shape, without half precision and second names.

    Raises:
        ValueError: It is no ONNX model.
    """
    model = parse(content, "it is no ONNX file")
    graph = model.graph
    constants = {one.name for one in graph.initializer}
    for value in graph.input:
        if value.name not in constants:
            for side, size in zip(value.type.tensor_type.shape.dim, shape):
                side.dim_value = size
    # They may have sizes that are open, or of another input; a runtime finds them by itself.
    del graph.value_info[:]
    _widen(graph)
    _use_own_names(graph, constants)
    return model.SerializeToString()


def _widen(graph: Any) -> None:
    helper = load_onnx().numpy_helper
    for values in (graph.input, graph.output, graph.value_info):
        for value in values:
            if value.type.tensor_type.elem_type == FLOAT16:
                value.type.tensor_type.elem_type = FLOAT
    for tensor in graph.initializer:
        _widen_tensor(helper, tensor)
    for node in graph.node:
        for attribute in node.attribute:
            if attribute.HasField("t"):
                _widen_tensor(helper, attribute.t)
            if attribute.HasField("g"):
                _widen(attribute.g)
            for inner in attribute.graphs:
                _widen(inner)
            if node.op_type == "Cast" and attribute.name == "to" and attribute.i == FLOAT16:
                attribute.i = FLOAT


def _widen_tensor(helper: Any, tensor: Any) -> None:
    if tensor.data_type == FLOAT16:
        wide = helper.to_array(tensor).astype("float32")
        tensor.CopyFrom(helper.from_array(wide, tensor.name))


def _use_own_names(graph: Any, constants: Any) -> None:
    """Removes each Identity of a constant, and names the constant where its output was used."""
    if sum(1 for _ in nodes_of(graph)) > len(graph.node):  # graphs inside may use these names, too
        return
    results = {one.name for one in graph.output}
    others: Dict[str, str] = {}
    kept = []
    for node in graph.node:
        source = others.get(node.input[0], node.input[0]) if node.input else ""
        outputs = [one for one in node.output if one not in results]
        if node.op_type == "Identity" and source in constants and outputs:
            others[outputs[0]] = source
        else:
            kept.append(node)
    for node in kept:
        for number, name in enumerate(node.input):
            node.input[number] = others.get(name, name)
    if others:
        del graph.node[:]
        graph.node.extend(kept)
