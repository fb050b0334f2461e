"""The live parameters of a node: changed through dynamic_reconfigure, and saved to a file."""

import copy
import os
import re
import sys
from typing import Any, Callable, Dict, Optional, TypeVar

import dynamic_reconfigure.server
import rospy
from std_srvs.srv import Trigger, TriggerResponse

from .. import _transport
from ..common.files import read_text, replace_file
from ..common.plain_text import brief, printable
from ..common.ranges import require_range
from .context import current
from .params import check, note_known, present_params, read_param

Params = TypeVar("Params")

OTHER_FILE_HINT = (
    "; ~config_file names the file, as config:=/absolute/path.yaml of the launch files does"
)
MAX_ERROR_LENGTH = 1000  # characters, including the path of a file


def attribute_of(name: str, prefix: str = "") -> str:
    """The core's name of a live parameter: minArea is min_area."""
    words = name[len(prefix) :] if name.startswith(prefix) else name
    return re.sub(r"[A-Z]", lambda letter: "_" + letter[0].lower(), words)


def filled(params: Params, config: Dict[str, Any], prefix: str = "") -> Params:
    """The core's parameters with the live ones of their names in them.

    Args:
        prefix: what live parameters have in front of the core's names.
    """
    for name, value in config.items():
        attribute = attribute_of(name, prefix)
        if hasattr(params, attribute):
            setattr(params, attribute, value)
    return params


class LiveParams:
    """Parameters that dynamic_reconfigure changes and the service ~save_parameters saves.

    Args:
        config_type: The module generated from the .cfg file, whose ranges apply.
        apply: A function that puts the values (by name) to use. It may correct them in place, or
            raise ValueError to refuse them. At start that ends the node. Later the old values
            stay, and a warning gives the reason.
        edit: A function that puts values into the text of the file that ~config_file names:
            edit(path, text, values) returns the new text. By default each value is a line of it.

    Raises:
        ValueError: A parameter has the wrong type, or was refused.
    """

    def __init__(
        self,
        config_type: Any,
        apply: Callable[[Dict[str, Any]], None],
        edit: Optional[Callable[[str, str, Dict[str, Any]], str]] = None,
    ):
        self._type = config_type
        self._apply = apply
        self._edit = edit or _transport.edit_params
        self._accepted: Dict[str, Any] = {}
        self._server = _Server(config_type, self._change, self._read())
        current().service("~save_parameters", Trigger, self._on_save)

    def _read(self) -> Dict[str, Any]:
        defaults, values = self._type.defaults, {}
        there = present_params(defaults)
        for name, default in defaults.items():
            value = there.get(name, default)
            note_known(name, value, default)
            values[name] = check(name, value, default, self._type.min[name], self._type.max[name])
        return values

    def _change(self, config: Dict[str, Any], _level: int) -> Dict[str, Any]:
        try:
            self._require_ranges(config)
            self._apply(config)
        except ValueError as error:
            if not self._accepted:
                raise
            rospy.logwarn("refused, the parameters stay as they are: %s", error)
            return copy.deepcopy(self._accepted)
        self._accepted = copy.deepcopy(config)
        return config

    def _require_ranges(self, config: Dict[str, Any]) -> None:
        for name, low in self._type.min.items():
            high = self._type.max[name]
            kind = type(self._type.defaults[name])
            # A client may have put a value into the list of another type.
            if type(config[name]) not in ((int, float) if kind is float else (kind,)):
                raise ValueError(
                    f"{name} is {brief(config[name])}, must be of type {kind.__name__}"
                )
            if low != "" and type(config[name]) is not bool:
                require_range(name, config[name], low, high)

    def _on_save(self, _request: Any) -> TriggerResponse:
        accepted = self._accepted  # This object is replaced, never changed.
        try:
            path = read_param("config_file", "")
            if not path:
                raise RuntimeError("~config_file does not name a file")
            # roslaunch and a node resolve a relative path in different folders.
            if not os.path.isabs(path):
                raise RuntimeError(f"~config_file is {brief(path)}, must be an absolute path")
            # As requireOwnLaunch() in C++ finds it; rospy goes by sys.argv as well.
            launched = any(word.startswith("__log:=") for word in sys.argv)
            _transport.require_own_launch(path, launched)
            values = {name: accepted[name] for name in self._type.defaults}
            replace_file(path, self._edit(path, read_text(path), values).encode())
        except (OSError, RuntimeError, ValueError) as error:
            # For instance, the file of an installed package may not be written.
            says = printable(str(error), MAX_ERROR_LENGTH)
            reason = f"{says}{OTHER_FILE_HINT if isinstance(error, OSError) else ''}"
            rospy.logerr("parameters not saved: %s", reason)
            return TriggerResponse(False, reason)
        return TriggerResponse(True, path)


class _Server(dynamic_reconfigure.server.Server):
    """A server that begins with these values, and gives the master all of them at once."""

    def __init__(
        self,
        config_type: Any,
        change: Callable[[Dict[str, Any], int], Dict[str, Any]],
        values: Dict[str, Any],
    ):
        self._values = values
        context = current()
        self._set = context.bind(super()._set_callback)
        context.closes(self._close)
        super().__init__(config_type, change, context.reconfigure_namespace)

    def _set_callback(self, request: Any) -> Any:
        return self._set(request)

    def _close(self) -> None:
        made = vars(self)  # by the constructor, unless the values were refused
        for name, end in (
            ("set_service", "shutdown"),
            ("update_topic", "unregister"),
            ("descr_topic", "unregister"),
        ):
            if name in made:
                getattr(made[name], end)()

    def _copy_from_parameter_server(self) -> None:
        self.config.update(self._values)

    def _copy_to_parameter_server(self) -> None:
        current().set_params({"~" + name: self.config[name] for name in self._values})

    def _clamp(self, config: Dict[str, Any]) -> None:
        """Keeps values out of range, so that the node refuses them instead of clamping them."""
