"""A fixture of the tests in a browser: the node dashboard."""

from typing import Any

import pytest
from dashboard_node import Dashboard


@pytest.fixture(scope="module")
def dashboard(start_once: Any, tmp_path_factory: Any) -> Dashboard:
    """One for all tests of a file."""
    return Dashboard(start_once, f"_bag_folder:={tmp_path_factory.mktemp('bags')}")
