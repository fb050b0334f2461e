"""What is said of the version in several places."""

import pathlib

from catkin_pkg import changelog, package

ROOT = pathlib.Path(__file__).resolve().parents[2]


def test_the_changelog_has_the_version_of_package_xml_as_its_newest():
    log = changelog.Changelog("robot_vision")
    changelog.populate_changelog_from_rst(log, (ROOT / "CHANGELOG.rst").read_text())
    versions = [version for version, _, _ in log.foreach_version(reverse=True)]
    # As changes come before their release, catkin lets them be under "Forthcoming".
    released = [version for version in versions if version != "forthcoming"]
    assert released[0] == package.parse_package(str(ROOT)).version
    assert "0.1.0" in released
