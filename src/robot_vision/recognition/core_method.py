"""Methods that learn by the core, whose parameters are a struct of it."""

from typing import Any, Dict, List, Mapping

from .. import validate
from ..common.plain_text import brief


class CoreMethod:
    """A method whose parameters are a struct of the core."""

    name = ""
    version = 1
    kind: Any = None

    @property
    def parameters(self) -> Dict[str, Any]:
        """The names and defaults of the parameters."""
        defaults = self.kind()
        return {name: getattr(defaults, name) for name in _fields_of(self.kind)}

    def complete(self, given: Mapping[str, Any]) -> Dict[str, Any]:
        """All parameters; raises ValueError if one of them cannot be."""
        params = self.params_of(given)
        return {name: getattr(params, name) for name in _fields_of(self.kind)}

    def params_of(self, given: Mapping[str, Any]) -> Any:
        """The struct with these values in it; raises ValueError if one of them cannot be."""
        params = self.kind()
        for name, value in given.items():
            number = float(value) if type(value) is int else value
            kind = type(getattr(params, name))
            if type(value) is not kind and not (kind is float and type(number) is float):
                raise ValueError(f"{name} is {brief(value)}, must be of the type {kind.__name__}")
            setattr(params, name, number if kind is float else value)
        validate(params)
        return params


def _fields_of(kind: Any) -> List[str]:
    return [name for name in dir(kind) if isinstance(getattr(kind, name), property)]
