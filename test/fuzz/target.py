"""What all targets are."""

import os
import tempfile
from typing import Any, List


class Target:
    """Something that takes bytes from others."""

    def seeds(self) -> List[bytes]:
        """Good ones."""
        raise NotImplementedError

    def run(self, data: bytes) -> None:
        """Takes them, or raises one of REFUSALS."""
        raise NotImplementedError


class Files(Target):
    """Something that reads a file by its path."""

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory()
        self.path = os.path.join(self._folder.name, "file")

    def run(self, data: bytes) -> None:
        with open(self.path, "wb") as file:
            file.write(data)
        self.read()

    def read(self) -> Any:
        raise NotImplementedError
