"""What there is in the graph of an ONNX model, also in the graphs inside of it."""

from typing import Any, Iterator


def nodes_of(graph: Any) -> Iterator[Any]:
    """Yields the nodes of a graph, and those of the graphs inside of If, Loop and Scan."""
    for node in graph.node:
        yield node
        for attribute in node.attribute:
            for inner in graphs_of(attribute):
                yield from nodes_of(inner)


def graphs_of(attribute: Any) -> Iterator[Any]:
    """Yields the graphs that an attribute of a node is."""
    if attribute.HasField("g"):
        yield attribute.g
    yield from attribute.graphs


def tensors_of(graph: Any) -> Iterator[Any]:
    """Yields the constants of a graph, also those of its nodes and of the graphs inside."""
    yield from graph.initializer
    for one in graph.sparse_initializer:
        yield one.values
        yield one.indices
    for node in graph.node:
        for attribute in node.attribute:
            if attribute.HasField("t"):
                yield attribute.t
            yield from attribute.tensors
            if attribute.HasField("sparse_tensor"):
                yield attribute.sparse_tensor.values
                yield attribute.sparse_tensor.indices
            for inner in graphs_of(attribute):
                yield from tensors_of(inner)


def text_of(value: Any) -> str:
    """Returns a text of a model, which protobuf gives as bytes if it is not UTF-8."""
    return value if isinstance(value, str) else bytes(value).decode(errors="replace")
