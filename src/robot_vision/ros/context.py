"""What a node needs of rospy, whether it runs alone or is one of several in its process.

rospy knows one node for each process. A node of this package asks context.current() for its name,
its private names and parameters, its topics and services: alone it is answered by rospy, and by a
LoadedContext when python_manager.py has loaded it.
"""

import contextlib
import contextvars
import threading
from typing import Any, Callable, Dict, Iterator, List, Optional, TypeVar

import rosgraph.names
import rospy
import rospy.impl.paramserver

from .master_calls import ask_master

Part = TypeVar("Part")
REQUIRED: Any = object()  # in place of a default: the parameter has to be set
# Messages that wait on a topic of all nodes, /tf or /diagnostics: rospy has one queue for those of
# a process, and two of them may publish at the same moment.
SHARED_QUEUE = 100
# Messages that wait to be received: rospy has one number for all who listen in a process.
MESSAGE_QUEUE = 10


class NodeContext:
    """The context of the node that rospy knows, for which rospy itself does all of it."""

    def __init__(self) -> None:
        self._parts: Dict[Any, Any] = {}
        self._parts_lock = threading.RLock()

    @property
    def name(self) -> str:
        """The name of the node, which begins with a slash."""
        return rospy.names.get_name()

    @property
    def namespace(self) -> str:
        """What relative names are resolved in; ends with a slash."""
        return rospy.get_namespace()

    @property
    def reconfigure_namespace(self) -> str:
        """The namespace for a server of dynamic_reconfigure: "" is that of rospy's node."""
        return ""

    @property
    def remappings(self) -> Dict[str, str]:
        """The names that stand for others, both resolved."""
        return rospy.names.get_resolved_mappings()

    def resolve(self, name: str) -> str:
        """Returns the global name of a topic, a service or a parameter, remapped if it is so."""
        return rospy.resolve_name(name)

    def remapped(self, name: str) -> str:
        """Returns the topic that a relative name is remapped to, "" if it is not remapped."""
        return self.remappings.get(self.namespace + name, "")

    def get_param(self, name: str, default: Any = REQUIRED) -> Any:
        """Returns a parameter; raises KeyError if it is not set and has no default."""
        key = self.given(name)
        return rospy.get_param(key) if default is REQUIRED else rospy.get_param(key, default)

    def private_params(self) -> Dict[str, Any]:
        """Returns all private parameters that are set, by their names without ~."""
        # rospy would answer with what it has been asked to keep, if that is anything.
        ((code, _, params),) = ask_master([("getParam", rospy.get_name(), self.name)])
        return params if code == 1 and isinstance(params, dict) else {}

    def has_param(self, name: str) -> bool:
        return rospy.has_param(self.given(name))

    def set_param(self, name: str, value: Any) -> None:
        rospy.set_param(self.given(name), value)

    def set_params(self, values: Dict[str, Any]) -> None:
        """Sets parameters by their names, all with one request to the master."""
        resolved = {rospy.resolve_name(self.given(name)): value for name, value in values.items()}
        ask_master([("setParam", rospy.get_name(), *item) for item in resolved.items()])
        for name, value in resolved.items():
            with contextlib.suppress(KeyError):  # It is not kept in this process.
                rospy.impl.paramserver.get_param_server_cache().update(name, value)

    def delete_param(self, name: str) -> None:
        rospy.delete_param(self.given(name))

    def publisher(self, name: str, kind: Any, **options: Any) -> rospy.Publisher:
        """Returns a rospy.Publisher, which is closed when the node ends."""
        return rospy.Publisher(self.given(name), kind, **options)

    def subscriber(
        self, name: str, kind: Any, callback: Callable[..., Any], **options: Any
    ) -> rospy.Subscriber:
        """Returns a rospy.Subscriber, which is closed when the node ends."""
        return rospy.Subscriber(self.given(name), kind, self.bind(callback), **options)

    def service(self, name: str, kind: Any, handle: Callable[[Any], Any]) -> rospy.Service:
        """Returns a rospy.Service, which is closed when the node ends."""
        return rospy.Service(self.given(name), kind, self.bind(handle))

    def thread(self, run: Callable[[], Any], name: str) -> threading.Thread:
        """Returns a thread of the node, which is not started yet and does not keep a process."""
        return threading.Thread(target=self.bind(run), name=name, daemon=True)

    def bind(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """Returns a function that any thread may call, to work in this context."""
        return function

    def part(self, make: Callable[[], Part]) -> Part:
        """Returns what a class or function makes, once for each node."""
        with self._parts_lock:
            if make not in self._parts:
                self._parts[make] = make()
            return self._parts[make]

    def on_end(self, callback: Callable[[], Any]) -> None:
        """Has a function called when the node begins to end, while all its topics are there."""
        rospy.on_shutdown(callback)

    def on_closing(self, callback: Callable[[], Any]) -> None:
        """Has a function called behind those of on_end(), before topics are closed."""
        rospy.core.add_preshutdown_hook(lambda _reason: callback())

    def closes(self, close: Callable[[], Any]) -> None:
        """Has something closed at the end, the newest first; rospy does so for its node."""

    def close(self, close: Callable[[], Any]) -> None:
        """Closes something now that would be closed at the end: close(publisher.unregister)."""
        close()

    def is_ending(self) -> bool:
        """Returns whether the node ends, or has ended."""
        return rospy.core.is_shutdown_requested()

    def exit(self, reason: str) -> None:
        """Ends this node, from any thread; others in its process go on."""
        rospy.signal_shutdown(reason)

    def given(self, name: str) -> str:
        """Returns a name as rospy gets it, which resolves it if it is its own node's."""
        return name


class LoadedContext(NodeContext):
    """The context of a node that was loaded into the process of another one.

    Args:
        name: The name of the node, which begins with a slash.
        remappings: Names by names, both resolved.
        on_exit: A function that is called with a reason when the node wants to end.
    """

    def __init__(
        self, name: str, remappings: Dict[str, str], on_exit: Callable[[str], Any]
    ) -> None:
        super().__init__()
        self._name = name
        _loaded.append(name)
        self._remappings = dict(remappings)
        self._on_exit = on_exit
        self._ending = threading.Event()
        self._has_ended = False
        self._end_callbacks: List[Callable[[], Any]] = []
        self._closing_callbacks: List[Callable[[], Any]] = []
        self._closes: List[Callable[[], Any]] = []

    @property
    def name(self) -> str:
        return self._name

    @property
    def namespace(self) -> str:
        return rosgraph.names.namespace(self._name)

    @property
    def reconfigure_namespace(self) -> str:
        return self._name

    @property
    def remappings(self) -> Dict[str, str]:
        return self._remappings

    def resolve(self, name: str) -> str:
        return rosgraph.names.resolve_name(name, self._name, self._remappings)

    def publisher(self, name: str, kind: Any, **options: Any) -> rospy.Publisher:
        made = super().publisher(name, kind, **options)
        self.closes(made.unregister)
        return made

    def subscriber(
        self, name: str, kind: Any, callback: Callable[..., Any], **options: Any
    ) -> rospy.Subscriber:
        made = super().subscriber(name, kind, callback, **options)
        self.closes(made.unregister)
        return made

    def service(self, name: str, kind: Any, handle: Callable[[Any], Any]) -> rospy.Service:
        made = super().service(name, kind, handle)
        self.closes(made.shutdown)
        return made

    def bind(self, function: Callable[..., Any]) -> Callable[..., Any]:
        def bound(*arguments: Any) -> Any:
            if self._has_ended:  # rospy calls listeners of a topic as long as others publish on it.
                return None
            with active(self):
                try:
                    return function(*arguments)
                except SystemExit as error:  # It may end this node, not the thread of others.
                    self.exit(f"a callback has called sys.exit({error.code!r})")
                    return None

        return bound

    def on_end(self, callback: Callable[[], Any]) -> None:
        self._end_callbacks.append(callback)

    def on_closing(self, callback: Callable[[], Any]) -> None:
        self._closing_callbacks.append(callback)

    def closes(self, close: Callable[[], Any]) -> None:
        self._closes.append(close)

    def close(self, close: Callable[[], Any]) -> None:
        with contextlib.suppress(ValueError):
            self._closes.remove(close)
        close()

    def is_ending(self) -> bool:
        return self._ending.is_set() or super().is_ending()

    def exit(self, reason: str) -> None:
        self._on_exit(reason)

    def finish(self) -> None:
        """Has the node end its work, while all that it has made is still there."""
        self._ending.set()
        self._call(self._end_callbacks)
        self._call(self._closing_callbacks)

    def end(self) -> None:
        """Ends the node, and closes all that was made through this context, the newest first."""
        self.finish()
        self._call(self._closes)
        self._has_ended = True
        self._parts.clear()
        with contextlib.suppress(ValueError):  # It may have been ended before.
            _loaded.remove(self._name)

    def _call(self, callbacks: List[Callable[[], Any]]) -> None:
        with active(self):
            while callbacks:
                _attempt(callbacks.pop())

    def given(self, name: str) -> str:
        return self.resolve(name)


def _attempt(function: Callable[[], Any]) -> None:
    """Calls a function of the end; if it fails, the others still have to be called."""
    try:
        function()
    except Exception as error:
        rospy.logerr("not all could be closed: %s", error)


_process_context = NodeContext()
_loaded: List[str] = []  # names of nodes
_current: "contextvars.ContextVar[Optional[NodeContext]]" = contextvars.ContextVar(
    "node", default=None
)


def current() -> NodeContext:
    """Returns the context of the node for which this thread works."""
    return _current.get() or _process_context


def loaded_names() -> List[str]:
    """Returns the names of the nodes that are loaded into this process."""
    return list(_loaded)


@contextlib.contextmanager
def active(context: NodeContext) -> Iterator[None]:
    """Has this thread work for a node."""
    token = _current.set(context)
    try:
        yield
    finally:
        _current.reset(token)
