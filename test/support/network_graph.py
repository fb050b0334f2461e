"""ONNX graphs in the making, whose scores are the mean colours of cells: see networks.py."""

from typing import Any, List, Sequence

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

SIZE = 64  # px, side of the input
CLASSES = 3
STRIDES = (8, 16, 32)


class Graph:
    """An ONNX graph in the making. What is made has a name, by which later nodes use it.

    Args:
        shape: of the input.
        kind: of all numbers, TensorProto.FLOAT or FLOAT16.
    """

    def __init__(self, shape: Sequence[Any] = (1, 3, SIZE, SIZE), kind: int = TensorProto.FLOAT):
        self._kind = kind
        self._type = (
            helper.tensor_dtype_to_np_dtype(kind)
            if hasattr(helper, "tensor_dtype_to_np_dtype")
            else onnx.mapping.TENSOR_TYPE_TO_NP_TYPE[kind]
        )
        self._inputs = [helper.make_tensor_value_info("images", kind, list(shape))]
        self._nodes: List[Any] = []
        self._constants: List[Any] = []
        self._outputs: List[Any] = []
        self._domains = [helper.make_opsetid("", 12)]

    def constant(self, values: np.ndarray) -> str:
        """The name of a constant; floating point numbers are made of the graph's type."""
        values = np.asarray(values)
        if values.dtype.kind == "f":
            values = values.astype(self._type)
        name = f"constant_{len(self._constants)}"
        self._constants.append(numpy_helper.from_array(np.ascontiguousarray(values), name))
        return name

    def node(self, operator: str, *inputs: str, **attributes: Any) -> str:
        """The name of the output of a new node."""
        name = f"{operator.lower()}_{len(self._nodes)}"
        self._nodes.append(helper.make_node(operator, list(inputs), [name], name, **attributes))
        return name

    def shaped(self, value: str, *shape: int) -> str:
        return self.node("Reshape", value, self.constant(np.array(shape, np.int64)))

    def custom(self, operator: str, domain: str, value: str) -> str:
        """The output of an operator that ONNX does not have."""
        self._domains.append(helper.make_opsetid(domain, 1))
        return self.node(operator, value, domain=domain)

    def output(self, value: str, name: str, shape: Sequence[Any]) -> None:
        """Makes a value an output of this name."""
        self._nodes.append(helper.make_node("Identity", [value], [name], "make_" + name))
        self._outputs.append(helper.make_tensor_value_info(name, self._kind, list(shape)))

    def scores(self, strides: Sequence[int] = STRIDES, order: str = "rgb") -> str:
        """The scores of all classes in all cells, (1, CLASSES, n)."""
        parts = []
        for stride in strides:
            weights = np.zeros((CLASSES, 3, stride, stride), np.float32)
            for class_id in range(CLASSES):
                weights[class_id, order.index("rgb"[class_id])] = 1.0 / stride**2
            parts.append(self.shaped(self._over_cells(weights), 1, CLASSES, -1))
        return parts[0] if len(parts) == 1 else self.node("Concat", *parts, axis=2)

    def varying(self, values: np.ndarray) -> str:
        """A constant that seems to depend on the image: runtimes may want that of an output."""
        filters = values.size // (SIZE // 8) ** 2
        nothing = self._over_cells(np.zeros((filters, 3, 8, 8), np.float32))
        return self.node("Add", self.shaped(nothing, *values.shape), self.constant(values))

    def _over_cells(self, weights: np.ndarray) -> str:
        sides = list(weights.shape[2:])
        name = self.constant(weights)
        return self.node("Conv", "images", name, kernel_shape=sides, strides=sides)

    def bytes(self, metadata: Any = ()) -> bytes:
        """The file."""
        graph = helper.make_graph(self._nodes, "tiny", self._inputs, self._outputs, self._constants)
        model = helper.make_model(graph, opset_imports=self._domains, producer_name="tests")
        model.ir_version = 7  # of ONNX 1.7, so that old runtimes read it, too
        helper.set_model_props(model, dict(metadata))
        return model.SerializeToString()
