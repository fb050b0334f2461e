"""What must hold of an ONNX file before a library gets it that would not survive it otherwise.

Runtimes check much by themselves, and differ in what they do not: OpenCV, for one, reads beyond the
values of a constant that has fewer than its sizes say, and takes names that nothing has for places
in memory.
"""

import math
from typing import Any, Sequence, Set

from ..common.plain_text import brief, printable
from .onnx_graph import graphs_of, nodes_of, tensors_of, text_of

EXTERNAL = 1  # TensorProto.DataLocation
# Bytes of a number of each type of ONNX (TensorProto.DataType).
SIZES = {1: 4, 2: 1, 3: 1, 4: 2, 5: 2, 6: 4, 7: 8, 9: 1, 10: 2, 11: 8, 12: 4, 13: 8, 16: 2}
# Where the numbers of a type are that are not raw; those of other types are in IN_32.
FIELDS = {1: "float_data", 7: "int64_data", 11: "double_data", 12: "uint64_data", 13: "uint64_data"}
IN_32 = "int32_data"
MAX_AXES = 8
MAX_SIDE = 1 << 20  # of what follows
SIDES = ("group", "kernel_shape", "strides", "dilations", "pads", "output_padding")
MAX_VALUES = 1 << 28  # numbers of a constant: what a model file has room for
# Operators whose inputs but the first one are settings, of which one that is not given, or the
# sides of a single number, may be an empty constant.
WITH_SETTINGS = (
    *("Clip", "Expand", "Pad", "ReduceSum", "Reshape", "Resize"),
    *("Slice", "Split", "Squeeze", "Tile", "Unsqueeze", "Upsample"),
)
COPIES = ("Cast", "Identity")  # to OpenCV another constant, where its input is one


def require_values(graph: Any) -> None:
    """Raises ValueError unless all constants have their values in the file itself.

    What is in other files is not read, as their names may lead anywhere.
    """
    for tensor in tensors_of(graph):
        name = printable(text_of(tensor.name)) or "without a name"
        if tensor.data_location == EXTERNAL:
            places = [text_of(one.value) for one in tensor.external_data if one.key == "location"]
            raise ValueError(
                f"its weights are in other files ({printable(', '.join(places))}), must be in the "
                "model itself, as onnx.save(onnx.load(path), path) of Python writes it"
            )
        sides = list(tensor.dims)
        if len(sides) > MAX_AXES or any(not 0 <= one <= MAX_VALUES for one in sides):
            raise ValueError(f"its constant {name} is of shape {brief(sides)}, which cannot be")
        _require_count(tensor, name, math.prod(sides))


def _require_count(tensor: Any, name: str, count: int) -> None:
    if tensor.data_type not in SIZES:
        return
    if tensor.raw_data:
        what, has, must = "bytes", len(tensor.raw_data), count * SIZES[tensor.data_type]
    else:
        what, has, must = "values", len(getattr(tensor, FIELDS.get(tensor.data_type, IN_32))), count
    if has != must:
        raise ValueError(f"its constant {name} has {has} {what}, must have {must}")


def require_operands(graph: Any) -> None:
    """Raises ValueError for what OpenCV would divide by, or read, though it is not there.

    These are constants that are empty, and the numbers of convolutions.
    """
    empty = {one.name for one in graph.initializer if 0 in one.dims}
    for node in nodes_of(graph):
        is_constant = node.op_type == "Constant" and any(0 in one.t.dims for one in node.attribute)
        is_copy = node.op_type in COPIES and not empty.isdisjoint(node.input)
        if is_constant or is_copy:
            empty.update(node.output)
        elif not empty.isdisjoint(_operands_of(node)):
            name, operator = printable(text_of(node.name)), printable(text_of(node.op_type))
            raise ValueError(f"its node {name} ({operator}) takes a constant that is empty")
        elif node.op_type in ("Conv", "ConvTranspose"):
            _require_sides(node)


def _operands_of(node: Any) -> Sequence[str]:
    """Returns those inputs of a node that have to have values."""
    if node.op_type == "ConstantOfShape":  # of a single number if its input is empty
        return ()
    return node.input[:1] if node.op_type in WITH_SETTINGS else node.input


def _require_sides(node: Any) -> None:
    for one in node.attribute:
        numbers = [one.i] if one.name == "group" else list(one.ints)
        low = 0 if one.name in ("pads", "output_padding") else 1
        if one.name in SIDES and any(not low <= number <= MAX_SIDE for number in numbers):
            raise ValueError(
                f"{one.name} of its convolution {printable(text_of(node.name))} is "
                f"{brief(numbers)}, must be from {low} to {MAX_SIDE}"
            )


def require_names(graph: Any) -> None:
    """Raises ValueError if a node takes, or the network gives, what nothing before it makes."""
    _require_names(graph, set())


def _require_names(graph: Any, outside: Set[str]) -> None:
    known = outside | {one.name for one in (*graph.input, *graph.initializer)}
    known.update(one.values.name for one in graph.sparse_initializer)
    for node in graph.node:
        missing = [name for name in node.input if name and name not in known]
        if missing:
            raise ValueError(
                f"its node {printable(text_of(node.name))} ({printable(text_of(node.op_type))}) "
                f"takes {printable(text_of(missing[0]))}, which nothing before it gives"
            )
        for attribute in node.attribute:
            for inner in graphs_of(attribute):
                _require_names(inner, known)
        known.update(node.output)
    missing = [one.name for one in graph.output if one.name not in known]
    if missing:
        raise ValueError(f"its output {printable(text_of(missing[0]))} is what no node gives")
