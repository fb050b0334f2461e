"""What the pages of docs/ say of nodes, for tests that compare it with the nodes."""

import itertools
import pathlib
import re
from typing import Dict, List, NamedTuple, Set

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
ABOUT = "| executable | nodelet | launch file | parameters |"
INTERFACE = "| topic or service | kind | type | content |"
ARGUMENTS = "| argument | meaning |"


class Node(NamedTuple):
    """What the page of a node says."""

    page: pathlib.Path
    nodelet: str  # empty: it is none
    launch_file: str
    config_file: str
    arguments: Set[str]  # of the launch file, without those that are common to many
    inputs: Dict[str, str]  # types of the topics by their names
    outputs: Dict[str, str]
    services: Dict[str, str]


def table(page: pathlib.Path, header: str) -> List[List[str]]:
    """The cells of the table below this line; none if the page does not have it."""
    lines = page.read_text(encoding="utf-8").splitlines()
    if header not in lines:
        return []
    rows = itertools.takewhile(lambda line: line.startswith("|"), lines[lines.index(header) + 2 :])
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]


def quoted(cell: str) -> str:
    """The first text in backquotes of a cell; empty if there is none."""
    return "".join(re.findall("`([^`]+)`", cell)[:1])


def links(text: str) -> Set[str]:
    """The files that a text of Markdown links to, without their anchors."""
    return {link.partition("#")[0] for link in re.findall(r"\]\(([^)\s]+)\)", text)}


def nodes() -> Dict[str, Node]:
    """The nodes that have a page, by their executables."""
    found = {}
    for page in sorted(DOCS.glob("*.md")):
        for executable, nodelet, launch_file, config_file in table(page, ABOUT):
            found[quoted(executable)] = Node(
                page,
                quoted(nodelet),
                quoted(launch_file),
                quoted(config_file),
                {quoted(argument) for argument, _ in table(page, ARGUMENTS)},
                *(interface(page, kind) for kind in ("input", "output", "service")),
            )
    return found


def interface(page: pathlib.Path, wanted: str) -> Dict[str, str]:
    """The types of a node's topics or services of one kind, by their names."""
    rows = table(page, INTERFACE)
    return {quoted(name): of_type for name, kind, of_type, _ in rows if kind == wanted}
