"""What we publish has the md5 sums of other packages' messages, by which their clients know it."""

import pytest
from foreign_messages import PUBLISHED, foreign_messages

import robot_vision.msg
import robot_vision.srv

NAMES = [(package, name) for package, sums in PUBLISHED.items() for name in sums]


@pytest.fixture(scope="module")
def theirs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("theirs")
    return {package: foreign_messages(package, folder) for package in PUBLISHED}


@pytest.mark.parametrize("package, name", NAMES)
def test_md5_sums(theirs, package, name):
    kind = "srv" if name.startswith("Get") else "msg"
    their_module, our_module = getattr(theirs[package], kind), getattr(robot_vision, kind)
    assert getattr(their_module, name)._md5sum == PUBLISHED[package][name]
    assert getattr(our_module, name)._md5sum == PUBLISHED[package][name]


@pytest.mark.parametrize("package", PUBLISHED)
def test_what_goes_over_the_wire(theirs, package):
    """The bytes of one are the other's: names of fields are not in the sums of embedded types."""
    module = theirs[package].msg
    names = [name for name in dir(module) if hasattr(getattr(module, name), "_slot_types")]
    assert len(names) > 3
    for name in names:
        ours, their_kind = getattr(robot_vision.msg, name), getattr(module, name)
        assert ours.__slots__ == their_kind.__slots__
        assert ours._md5sum == their_kind._md5sum
        their_types = [kind.replace(package, "robot_vision") for kind in their_kind._slot_types]
        assert ours._slot_types == their_types
