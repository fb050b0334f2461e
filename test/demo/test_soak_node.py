"""A short run of the soak: what a demo holds is what it held before others came and went."""

import os
import pathlib
import sys

import pytest
import support

SOAK = pathlib.Path(__file__).resolve().parents[1] / "benchmarks" / "soak"
MINUTES = 0.25


@pytest.mark.parametrize("way", ["one", "several"])
def test_what_others_have_taken_is_given_back(tmp_path, way):
    """The soak has a master of its own, so that it is a process of its own, too."""
    command = [sys.executable, str(SOAK), str(MINUTES), way]
    process = support.Process(command, tmp_path / "soak.log", {"PATH": os.environ["PATH"]})
    try:
        assert process.exit_code(400.0) == 0, process.output()
        assert "| code_reader |" in process.output()
    finally:
        process.end()
