"""What an ONNX file says of its network, read with python3-onnx.

https://github.com/onnx/onnx/blob/main/docs/IR.md defines the format.
"""

import warnings
from collections import Counter
from typing import Any, List, Optional, Set

from ..common.plain_text import printable
from .model_facts import KINDS, ModelFile, Tensor
from .onnx_check import require_values
from .onnx_graph import nodes_of, text_of

OWN_DOMAINS = ("", "ai.onnx", "ai.onnx.ml")
ONNXRUNTIME_DOMAIN = "com.microsoft"  # operators that only onnxruntime has
# NumPy's names of ONNX' types (TensorProto.DataType).
TYPES = {
    1: "float32",
    2: "uint8",
    3: "int8",
    4: "uint16",
    5: "int16",
    6: "int32",
    7: "int64",
    9: "bool",
    10: "float16",
    11: "float64",
    16: "bfloat16",
}
FLOAT, FLOAT16 = 1, 10


def load_onnx() -> Any:
    """Returns the module onnx with those of its parts that are used here.

    Only what reads ONNX files needs it.

    Raises:
        ValueError: It is not installed.
    """
    try:
        import onnx
        import onnx.numpy_helper
        import onnx.shape_inference
    except ImportError as error:
        raise ValueError(
            "to read ONNX files the module onnx is needed (apt install python3-onnx, which Ubuntu "
            f"20.04 does not have: it runs networks of other kinds): {error}"
        ) from None
    return onnx


def parse(content: bytes, otherwise: str) -> Any:
    """Returns onnx.ModelProto of a file's content.

    Raises:
        ValueError: It is none, which `otherwise` says, or python3-onnx is not installed.
    """
    model = load_onnx().ModelProto()
    try:
        with warnings.catch_warnings():  # which some versions only give for damaged files
            warnings.simplefilter("error")
            model.ParseFromString(content)
    except Exception as error:  # of protobuf, whose versions have different ones
        raise ValueError(f"{otherwise}: {printable(str(error))}") from None
    return model


def read_onnx(path: str, content: bytes, named_so: bool) -> ModelFile:
    """Returns what an ONNX file says.

    Args:
        path: The path, which is kept.
        content: The bytes of the file.
        named_so: Whether its suffix is .onnx, for the error message.

    Raises:
        ValueError: It is no ONNX file, is damaged, or has its weights elsewhere.
    """
    what = "it is damaged, or no ONNX file" if named_so else f"{KINDS}, and it is none of these"
    model = parse(content, what)
    graph = model.graph
    if not model.ir_version or not graph.node or not graph.output:
        raise ValueError(f"{what}: it has no network")
    require_values(graph)
    constants = {one.name for one in graph.initializer}
    inputs = tuple(_tensor(one) for one in graph.input if one.name not in constants)
    outputs = tuple(map(_tensor, graph.output))
    operators = Counter(text_of(node.op_type) for node in nodes_of(graph))
    producer = f"{text_of(model.producer_name)} {text_of(model.producer_version)}"
    own = [one.version for one in model.opset_import if one.domain in ("", "ai.onnx")]
    return ModelFile(
        path,
        "onnx",
        content,
        inputs=inputs,
        outputs=outputs,
        metadata={text_of(one.key): text_of(one.value) for one in model.metadata_props},
        producer=printable(producer.strip()),
        opset=max(own, default=0),
        operators=dict(operators),
        custom=tuple(sorted(_custom(model))),
        parameters=sum(_count(one.dims) for one in graph.initializer),
        half=any(one.type == "float16" for one in inputs + outputs)
        or any(one.data_type == FLOAT16 for one in graph.initializer),
    )


def _custom(model: Any) -> Set[str]:
    """Returns the operators that neither ONNX nor the file itself defines."""
    defined = {(one.domain, one.name) for one in getattr(model, "functions", ())}
    return {
        printable(f"{text_of(node.domain)}.{text_of(node.op_type)}")
        for node in nodes_of(model.graph)
        if node.domain not in OWN_DOMAINS and (node.domain, node.op_type) not in defined
    }


def _tensor(value: Any) -> Tensor:
    kind = value.type.tensor_type
    sides: List[Optional[int]] = [
        side.dim_value if side.dim_value > 0 else None for side in kind.shape.dim
    ]
    type_name = TYPES.get(kind.elem_type, f"type {kind.elem_type}")
    return Tensor(printable(text_of(value.name)), tuple(sides), type_name)


def _count(sides: Any) -> int:
    count = 1
    for side in sides:
        count *= max(0, side)
    return count
