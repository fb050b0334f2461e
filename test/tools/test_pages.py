"""The README and the pages of docs/ against the files of the package."""

import pathlib
import re
from xml.etree import ElementTree

import pages
import pytest

README = pages.ROOT / "README.md"
NODES = pages.nodes()
COMMON = {"image", "view", "config", "synthetic"}  # arguments that docs/nodes.md describes


def test_the_readme_is_short():
    assert README.stat().st_size <= 8000


def test_every_nodelet_has_a_page():
    declared = (pages.ROOT / "nodelet_plugins.xml").read_text()
    assert {node.nodelet for node in NODES.values() if node.nodelet} == set(
        re.findall(r'class name="([^"]+)"', declared)
    )


def test_the_readme_lists_the_pages_of_all_nodes():
    rows = pages.table(README, "| node | what it does |")
    listed = sorted(link for cell, _ in rows for link in pages.links(cell))
    assert listed == sorted(f"docs/{node.page.name}" for node in NODES.values())


@pytest.mark.parametrize("name", NODES)
def test_a_node_s_launch_file_is_what_its_page_says(name):
    node = NODES[name]
    launch = ElementTree.parse(pages.ROOT / "launch" / node.launch_file).getroot()
    assert name in {started.get("type") for started in launch.iter("node")}
    arguments = {arg.get("name"): arg for arg in launch.findall("arg")}
    assert node.arguments == arguments.keys() - COMMON
    assert (pages.ROOT / node.config_file).is_file()
    assert arguments["config"].get("default") == f"$(find robot_vision)/{node.config_file}"


@pytest.mark.parametrize("name", NODES)
def test_a_node_s_page_has_an_image_of_its_name(name):
    page = NODES[name].page
    assert f"images/{page.stem}.jpg" in pages.links(page.read_text())


def test_every_launch_file_of_opencv_apps_has_its_like():
    (rows,) = [
        text.partition("\n\n")[0]
        for text in (pages.ROOT / "docs/basics.md")
        .read_text()
        .split("| opencv_apps | here |\n|---|---|\n")[1:]
    ]
    named = {
        name for row in rows.splitlines() for name in re.findall(r"`(\w+)`", row.split("|")[1])
    }
    shares = [pathlib.Path("/usr/share"), *pathlib.Path("/opt/ros").glob("*/share")]
    theirs = [path for share in shares for path in share.glob("opencv_apps/launch/*.launch")]
    assert named >= {path.stem for path in theirs} and len(named) >= 26


def test_the_index_lists_all_pages():
    index = pages.DOCS / "index.md"
    everything = {page.name for page in pages.DOCS.glob("*.md")} - {index.name}
    assert everything <= pages.links(index.read_text())


@pytest.mark.parametrize("kind", ["msg", "srv"])
def test_all_messages_and_services_are_listed(kind):
    listed = pages.links((pages.DOCS / "messages.md").read_text())
    files = {f"../{kind}/{path.name}" for path in (pages.ROOT / kind).iterdir()}
    assert files == {link for link in listed if link.endswith("." + kind)}
