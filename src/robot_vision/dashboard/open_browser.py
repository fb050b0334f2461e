"""Opens a page in the browser of the desktop, if there is one."""

import os
import shutil
import subprocess
import threading

PROGRAMS = ("xdg-open", "x-www-browser")


def open_browser(url: str) -> bool:
    """Opens a page in the user's browser; returns whether one is started.

    It does nothing without a display, where a browser for terminals would take this one.
    """
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return False
    program = next(filter(None, map(shutil.which, PROGRAMS)), None)
    if program is None:
        return False
    # In a session of its own Ctrl-C, which ends the node, does not end the browser.
    try:
        process = subprocess.Popen(
            [program, url],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
    except OSError:
        return False
    threading.Thread(target=process.wait, name="browser", daemon=True).start()
    return True
