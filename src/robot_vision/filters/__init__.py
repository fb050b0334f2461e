"""Operations on images, each as OpenCV does it, and chains of them, without ROS.

>>> from robot_vision import filters
>>> filters.gaussian(image, size=7)
>>> filters.chain(image, ["gray", "gaussian", "canny"], gaussian_size=7, canny_high=120.0)
"""

import inspect
from typing import Any, Callable, Optional, Sequence

import numpy as np

from .. import FilterChain, Operation, operations

__all__ = ["chain", "operations", *(operation.name for operation in operations())]


def chain(
    image: np.ndarray,
    names: Sequence[str],
    encoding: str = "bgr8",
    second: Optional[np.ndarray] = None,
    second_encoding: str = "bgr8",
    **values: Any,
) -> np.ndarray:
    """What the operations make of an image, one after the other.

    `values` are parameters by the name of the operation and their own: gaussian_size=7. Operations
    on two images (blend, difference, mask) take `second` as the other one, or `image` if it is
    None.

    Raises:
        ValueError: A name, a parameter (with its value and what it must be) or an image cannot be
            used.
    """
    return FilterChain(list(names), values).apply(image, encoding, second, second_encoding)


def _function(operation: Operation) -> Callable[..., np.ndarray]:
    """The operation as a function of an image, its parameters and the image's encoding."""

    def apply(*args: Any, **kwargs: Any) -> np.ndarray:
        given = signature.bind(*args, **kwargs).arguments
        images = {name: given.pop(name) for name in IMAGES if name in given}
        values = {f"{operation.name}_{name}": value for name, value in given.items()}
        return FilterChain([operation.name], values).apply(**images)

    kind = inspect.Parameter.POSITIONAL_OR_KEYWORD
    parameters = [inspect.Parameter("image", kind)]
    for param in operation.params:
        parameters.append(inspect.Parameter(param.name, kind, default=param.initial))
    for name in IMAGES[1:] if operation.second else IMAGES[1:2]:
        default = None if name == "second" else "bgr8"
        parameters.append(inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default))
    signature = inspect.Signature(parameters)
    apply.__signature__ = signature  # type: ignore[attr-defined]
    apply.__name__ = apply.__qualname__ = operation.name
    lines = [f"{param.name}: {param.doc}" for param in operation.params]
    apply.__doc__ = "\n".join([operation.meaning, "", *lines]).strip()
    return apply


IMAGES = (
    "image",
    "encoding",
    "second",
    "second_encoding",
)  # what no operation's parameter is named

globals().update({operation.name: _function(operation) for operation in operations()})
