"""Debian's chromium, driven for tests: one for all of them, with an empty window for each.

Errors on a page's console, violations of its Content-Security-Policy among them, fail the test.
"""

import contextlib
import os
import pathlib
import shutil
from typing import Any, Dict, Iterator, List, Optional, Set

import pytest
import support
from browser_page import Page

OPTIONS = (
    "--headless=new",
    "--disable-gpu",
    "--use-angle=swiftshader",  # WebGL without a graphics card
    "--enable-unsafe-swiftshader",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-background-timer-throttling",
    "--disable-renderer-backgrounding",
    "--disable-backgrounding-occluded-windows",
    "--no-first-run",
    "--no-default-browser-check",
    "--no-proxy-server",
    "--force-color-profile=srgb",
    "--hide-scrollbars",
    "--mute-audio",
)


def missing() -> str:
    """What is not there of a browser and of what drives it, in words; "" if it all is."""
    for program in ("chromium", "chromedriver"):
        path = shutil.which(program)
        if not path:
            return f"there is no {program}"
        if "/snap/" in path or os.path.basename(os.path.realpath(path)) == "snap":
            return f"{program} is a snap, which sees no private folder"
    try:
        import selenium  # noqa: F401
    except ImportError:
        return "there is no python3-selenium"
    return ""


class Browser:
    """A chromium whose profile is below `folder`; it ends with close().

    Args:
        loads: the strategy of page loads, "none" for pages that never end loading.
        traffic: whether it keeps what Page.traffic() tells of: all that comes to pages, each image
            among it.
    """

    def __init__(
        self, folder: pathlib.Path, *options: str, loads: str = "normal", traffic: bool = False
    ):
        from selenium import webdriver
        from selenium.webdriver.chrome.options import Options
        from selenium.webdriver.chrome.service import Service

        chosen = Options()
        chosen.binary_location = shutil.which("chromium")
        root = ["--no-sandbox"] if os.geteuid() == 0 else []
        for option in (*OPTIONS, *options, *root, f"--user-data-dir={folder / 'profile'}"):
            chosen.add_argument(option)
        logs = ("browser", "performance") if traffic else ("browser",)
        chosen.set_capability("goog:loggingPrefs", dict.fromkeys(logs, "ALL"))
        self.downloads = folder / "downloads"
        self.downloads.mkdir()
        private = {"HOME": folder, "XDG_CONFIG_HOME": folder, "XDG_CACHE_HOME": folder}
        service = Service(
            shutil.which("chromedriver"),
            port=support.free_port(),
            env={**os.environ, **{name: str(path) for name, path in private.items()}},
        )
        chosen.set_capability("unhandledPromptBehavior", "ignore")
        chosen.page_load_strategy = loads
        self.driver = webdriver.Chrome(service=service, options=chosen)
        self.driver.set_page_load_timeout(support.DEADLINE)
        self.driver.set_script_timeout(support.DEADLINE)
        self._first = self.driver.current_window_handle
        self._empty: Optional[str] = None  # a window for the next page
        self.origins: Set[str] = set()  # of all pages that have been opened

    def page(self) -> Page:
        """An empty window. What earlier ones stored is forgotten."""
        if self._empty:
            self.driver.switch_to.window(self._empty)
            self._empty = None
        else:
            self.driver.switch_to.new_window("window")  # of two tabs one would be hidden
        page = Page(self)
        page.forget_emulation()
        page.command("Network.clearBrowserCookies")
        for origin in self.origins:
            page.command("Storage.clearDataForOrigin", origin=origin, storageTypes="all")
        page.command(
            "Browser.setDownloadBehavior", behavior="allow", downloadPath=str(self.downloads)
        )
        return page

    def end_pages(self) -> None:
        """Empties a window for the next page, as a new one takes a second, and closes the others.

        The browser's own first window stays as it is.
        """
        for handle in self.driver.window_handles:
            if handle in (self._first, self._empty):
                continue
            self.driver.switch_to.window(handle)
            if self._empty:
                self.driver.close()
            else:
                self.driver.get("about:blank")
                self._empty = handle
        self.driver.switch_to.window(self._first)

    def logs(self, kind: str) -> List[Dict[str, Any]]:
        """What has been logged since the last call: "browser", or "performance" for traffic."""
        return self.driver.get_log(kind)

    def close(self) -> None:
        self.driver.quit()


@contextlib.contextmanager
def running(folder: pathlib.Path, *options: str, **how: Any) -> Iterator[Browser]:
    """A browser for as long as the context lasts."""
    browser = Browser(folder, *options, **how)
    try:
        yield browser
    finally:
        browser.close()


@pytest.fixture(scope="session")
def browser(tmp_path_factory: Any) -> Iterator[Browser]:
    """The browser of all tests; they are skipped where there is none."""
    lacking = missing()
    if lacking:
        pytest.skip(f"no browser to test with: {lacking}")
    with running(tmp_path_factory.mktemp("browser")) as made:
        yield made


@pytest.fixture
def browser_with_traffic(browser: Browser, tmp_path: pathlib.Path) -> Iterator[Browser]:
    """A browser that keeps what Page.traffic() tells of, for one test."""
    with running(tmp_path, traffic=True) as made:
        yield made


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """A window of 1280x720 px, whose console must stay free of errors."""
    made = browser.page()
    made.size(1280, 720)
    browser.logs("browser")
    yield made
    try:
        made.front().check()
    finally:
        browser.end_pages()
