"""The node dashboard, which serves a page to see, tune, teach and record with a browser."""

import time
import xml.etree.ElementTree
from typing import Any

import rosgraph.network
import rospy
from std_srvs.srv import Trigger, TriggerResponse

from ..common.package_path import package_path
from ..ros.params import review_params
from ..ros.startup import run_node
from .access import Access, is_loopback
from .features import close_all, make_features, operations_of, routes_of
from .log_bridge import log_through_ros
from .open_browser import open_browser
from .private_address import is_kept, write_address
from .server import Server, bind
from .settings import read_settings

STDOUT = 1  # descriptor of what is printed


class Dashboard:
    """Serves a page at the address that it prints, http://127.0.0.1:8080/?token=...

    The page shows the images of all topics with what the nodes have found in them, and the state of
    the nodes; it changes parameters, teaches nodes, calibrates cameras and records bags. The node
    subscribes only to what somebody looks at. The service ~print_address prints the address again.

    Raises:
        ValueError: A parameter cannot be used, or there is no free port.
    """

    def __init__(self) -> None:
        log_through_ros()
        settings = read_settings()
        sockets = bind(settings.address, settings.port, settings.port_tries)
        self._access = Access(
            settings.address,
            sockets[0].getsockname()[1],
            settings.token,
            settings.view_token,
            settings.hosts,
            _name_for_others(),
        )
        self._address = settings.address
        version = _version()  # once, as pages are told it by the server's thread
        self._features = make_features(settings)
        self._server = Server(
            sockets,
            self._access,
            operations_of(self._features),
            routes_of(self._features),
            hello=lambda: {"version": version, "node": rospy.get_name(), "time": time.time()},
            max_clients=settings.max_clients,
            expected=(rospy.ROSException, rospy.ServiceException),
        )
        rospy.on_shutdown(self._close)
        review_params()
        self._print_address()
        rospy.Service("~print_address", Trigger, self._on_print_address)
        if settings.open_browser:
            open_browser(self._access.url_with_code(settings.address))

    def _print_address(self) -> str:
        """Prints the address with its token, which no log shall have: others can read that.

        Returns:
            Where it is, in words.
        """
        lines = [f"dashboard: {self._access.url(self._address)}"]
        if self._access.view_token:
            lines.append(f"to look only: {self._access.url(self._address, 'view')}")
        text = "\n".join(lines)
        if is_kept(STDOUT):
            path = write_address(rospy.get_name(), text + "\n")
            rospy.logwarn("the address is in %s, for what is printed here is kept in a log", path)
            return f"the address is in {path}"
        print(text, flush=True)
        return "the address is printed where the dashboard was started"

    def _on_print_address(self, _request: Any) -> TriggerResponse:
        return TriggerResponse(True, self._print_address())

    def _close(self) -> None:
        self._server.close()
        close_all(self._features)


def _name_for_others() -> str:
    """The name of this machine that ROS tells other machines, or "" if they cannot use it."""
    name = rosgraph.network.get_host_name()
    return "" if is_loopback(name) else name


def _version() -> str:
    """The package's version; rospkg's manifests take seconds, as they look for all of rosdep."""
    root = xml.etree.ElementTree.parse(package_path("package.xml"))
    return root.findtext("version", "").strip()


def main() -> None:
    run_node("dashboard", Dashboard, own_process=True)
