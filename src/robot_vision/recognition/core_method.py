"""Methods that learn by the core, whose parameters are a struct of it."""

from typing import Any, Dict, List, Mapping, Sequence, Tuple

from .. import validate
from ..common.plain_text import brief


class CoreMethod:
    """A method whose parameters, models and matcher are classes of the core."""

    name = ""
    version = 1
    kind: Any = None
    model: Any = None
    matcher: Any = None

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
            if name not in self.parameters:
                known = ", ".join(self.parameters)
                raise ValueError(f"{brief(name)} is no parameter, must be one of {known}")
            kind = type(getattr(params, name))
            try:
                number = float(value) if kind is float and type(value) is int else value
                if type(number) is not kind:
                    raise TypeError
                setattr(params, name, number)
            except (TypeError, OverflowError):
                kinds = f"of the type {kind.__name__}"
                raise ValueError(f"{name} is {brief(value)}, must be {kinds}") from None
        validate(params)
        return params

    def check_model(self, data: bytes) -> None:
        """Raises ValueError unless this is what it has learned, and all of it."""
        with_models(self.matcher(), self.model, [(0, data)])


def with_models(
    matcher: Any, kind: Any, models: Sequence[Tuple[int, bytes]]
) -> Tuple[Any, List[int]]:
    """Returns a matcher after models were added to it, and their numbers.

    Args:
        matcher: The matcher.
        kind: The class of its models.
        models: What was learned, each with its number.

    Raises:
        ValueError: A model is damaged.
    """
    for _, data in models:
        matcher.add(kind.from_bytes(data))
    return matcher, [number for number, _ in models]


def _fields_of(kind: Any) -> List[str]:
    return [name for name in dir(kind) if isinstance(getattr(kind, name), property)]
