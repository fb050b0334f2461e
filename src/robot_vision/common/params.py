"""Parameters of the core by their names."""

from typing import Any, Mapping, TypeVar

Params = TypeVar("Params")


def with_values(params: Params, values: Mapping[str, Any]) -> Params:
    """Sets parameters by their names, and returns them.

    Raises:
        AttributeError: There is no parameter of this name.
    """
    for name, value in values.items():
        if not hasattr(params, name):
            raise AttributeError(f"there is no parameter {name} of {type(params).__name__}")
        setattr(params, name, value)
    return params
