"""The README and the pages of docs/ against the files of the package."""

import pathlib
import re
from xml.etree import ElementTree

import pages
import pytest

README = pages.ROOT / "README.md"
NODES = pages.nodes()
COMMON = {
    "image",
    "view",
    "config",
    "synthetic",
    "manager",
}  # arguments that docs/nodes.md describes


def test_the_readme_is_short():
    """Its tables grow with the package, so only the prose around them is measured."""
    lines = README.read_text().splitlines(keepends=True)
    assert len("".join(line for line in lines if not line.startswith("|"))) <= 4000


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
    arguments = {arg.get("name"): arg for arg in launch.findall("arg")}
    loads = "manager" in arguments
    program = f"$(eval 'nodelet' if manager != 'none' else '{name}')" if loads else name
    assert program in {started.get("type") for started in launch.iter("node")}
    assert node.arguments == arguments.keys() - COMMON
    assert (pages.ROOT / node.config_file).is_file()
    assert arguments["config"].get("default") == f"$(find robot_vision)/{node.config_file}"


@pytest.mark.parametrize("name", NODES)
def test_a_node_s_page_has_an_image_of_its_name(name):
    page = NODES[name].page
    assert f"images/{page.stem}.jpg" in pages.links(page.read_text())


def text_of_all_pages():
    """The README and all pages in one text, with the lines that go on in the next one joined."""
    texts = (path.read_text(encoding="utf-8") for path in [README, *pages.DOCS.glob("*.md")])
    return "".join(texts).replace("\\\n", " ")


def test_launch_files_have_the_arguments_that_pages_give_them():
    command = r"roslaunch (?:--ros-args )?robot_vision ([\w-]+\.launch)((?: +\w+:=[^\s`]+)*)"
    found = re.findall(command, text_of_all_pages())
    assert len(found) > 50
    for name, given in found:
        arguments = ElementTree.parse(pages.ROOT / "launch" / name).getroot().findall("arg")
        known = {argument.get("name") for argument in arguments}
        assert known >= set(re.findall(r"(\w+):=", given)), name + given


def test_nodes_have_the_parameters_that_pages_set():
    text = (pages.DOCS / "parameters.md").read_text()
    sections = re.split(r"^### (\w+)$", text, flags=re.MULTILINE)
    known = {
        node: set(re.findall(r"^\| `(\w+)` \|", rows, re.MULTILINE))
        for node, rows in zip(sections[1::2], sections[2::2])
    }
    found = re.findall(r"dynparam set /(\w+) (\S.*)", text_of_all_pages())
    assert len(found) > 20
    for node, given in found:
        several = given.startswith(('"{', "'{"))
        names = re.findall(r"(\w+): ", given) if several else given.split()[:1]
        assert known[node.replace("usb_cam", "camera")] >= set(names), f"/{node} {given}"


def test_every_nodelet_of_opencv_apps_has_its_like():
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
    declared = [path for share in shares for path in share.glob("opencv_apps/nodelet_plugins.xml")]
    theirs = {
        name for path in declared for name in re.findall(r'"opencv_apps/(\w+)"', path.read_text())
    }
    assert named >= theirs and len(named) >= 29


def test_the_index_lists_all_pages():
    index = pages.DOCS / "index.md"
    everything = {page.name for page in pages.DOCS.glob("*.md")} - {index.name}
    assert everything <= pages.links(index.read_text())


@pytest.mark.parametrize(
    "topic, recorded",
    [
        ("/usb_cam/image_raw", False),
        ("/usb_cam/image_raw/compressed", True),
        ("/usb_cam/image_mono/compressed", False),
        ("/camera/depth/image_raw", False),
        ("/camera/depth/image_raw/compressedDepth", True),
        ("/camera/depth/image_raw/shm", False),
        ("/camera/depth/camera_info", True),
        ("/edge_detector/processed_image/theora", False),
    ],
)
def test_the_page_records_each_image_once_and_depths_too(topic, recorded):
    """rosbag leaves out a topic whose whole name the expression matches."""
    (left_out,) = re.findall(
        r"rosbag record -a -x '(.*)'", (pages.DOCS / "transports.md").read_text()
    )
    assert (re.fullmatch(left_out, topic) is None) == recorded


@pytest.mark.parametrize("kind", ["msg", "srv"])
def test_all_messages_and_services_are_listed(kind):
    listed = pages.links((pages.DOCS / "messages.md").read_text())
    files = {f"../{kind}/{path.name}" for path in (pages.ROOT / kind).iterdir()}
    assert files == {link for link in listed if link.endswith("." + kind)}
