"""A network that has been read, tried once, and understood."""

import dataclasses
from typing import List, Optional, Tuple

import numpy as np

from ..common.errors import about
from ..common.plain_text import printable
from .class_names import given_names, names_for
from .head import Head
from .heads import by_values, guess_head
from .input_preferences import InputPreferences, chosen
from .model_facts import ModelFile, joined, shape_text
from .model_file import read_model
from .network_input import NetworkInput, input_of
from .runtime import on_processors
from .runtimes import NetworkError, Runtime, advice_for, make_runtime


@dataclasses.dataclass(frozen=True)
class NetworkSettings:
    """Which model is run, and how; what is empty, 0 or auto is found from the model."""

    model: str  # path of the model, or of one of its two files
    weights: str = ""  # path of the other file
    class_names: str = ""  # path of a file of names, coco or voc
    backend: str = "auto"  # auto, onnxruntime or opencv
    threads: int = 1  # of onnxruntime; 0: all processors. OpenCV's are those of the process
    affinity: Tuple[int, ...] = ()  # processors that it may run on; empty: any
    head: str = "auto"  # as HeadParams names it
    task: str = "auto"  # detect, segment, pose or oriented
    input_width: int = 0  # px
    input_height: int = 0  # px
    fit: str = "auto"  # letterbox, stretch or corner
    pad: int = -1  # 0 to 255
    order: str = "auto"  # rgb or bgr
    mean: Tuple[float, ...] = ()  # of values from 0 to 255, three, in the network's order
    std: Tuple[float, ...] = ()  # the same
    background: bool = True  # whether class 0 of an ssd is no object


@dataclasses.dataclass(frozen=True)
class Network:
    """A network that has been run once, with zeros."""

    model: ModelFile  # without the content of its files
    input: NetworkInput
    image: InputPreferences
    runtime: Runtime
    outputs: Tuple[np.ndarray, ...]  # of the run with zeros
    head: Head
    names: Tuple[str, ...]  # of the classes
    advice: str  # what would make it faster, or nothing

    def __str__(self) -> str:
        """What a node logs at start, in one line."""
        size = f"{self.input.width}x{self.input.height}"
        task = "" if self.head.task == "detect" else f" ({self.head.task})"
        classes = f"{len(self.names)} classes, " if self.head.counted else ""
        return (
            f"{self.model.path}: {self.head.head}{task} on {self.runtime.name}, {size} px "
            f"{self.image.order}, {classes}for {self.head.reason}"
        )


def open_network(settings: NetworkSettings, model: Optional[ModelFile] = None) -> Network:
    """Reads a network and runs it once.

    Args:
        settings: Which, and how.
        model: The content of its files, if they have been read.

    Raises:
        OSError: A file cannot be read.
        ValueError: The model cannot be used; one line says which file, and why.
    """
    model = model or read_model(settings.model, settings.weights)
    names = given_names(settings.class_names)
    with about(model.path):
        network_input = input_of(model, settings.input_width, settings.input_height)
        runtime = make_runtime(
            model, network_input, settings.backend, settings.threads, settings.affinity
        )
        outputs = first_run(runtime, network_input)
        head = guess_head(
            model,
            network_input,
            [one.shape for one in outputs],
            runtime.output_names,
            settings.head,
            settings.task,
            [len(one) for one in names],
        )
        if settings.head == "auto":
            head = by_values(head, outputs[0], network_input)
        image = chosen(model, head, network_input, settings)
        named = names_for(model.metadata, head, names, settings.class_names)
    return Network(
        dataclasses.replace(model, data=b"", description=b""),
        network_input,
        image,
        runtime,
        tuple(outputs),
        head,
        tuple(named),
        advice_for(model, runtime),
    )


def first_run(runtime: Runtime, network_input: NetworkInput) -> List[np.ndarray]:
    """Returns the outputs of zeros.

    Raises:
        ValueError: The runtime throws, so that it cannot run this network at all.
    """
    try:
        # The threads that this one starts later have other work, and belong on any processor.
        with on_processors(set()):
            return runtime.run(np.zeros(network_input.shape, np.float32))
    except NetworkError as error:
        raise ValueError(f"{error}, with a first image of zeros") from None


def output_text(network: Network) -> str:
    """Returns the outputs with their shapes, as people read them."""
    return joined(
        [
            f"{printable(name)} {shape_text(one.shape)}"
            for name, one in zip(network.runtime.output_names, network.outputs)
        ]
    )
