"""What we publish has the md5 sums of object_recognition_msgs, by which its clients know it."""

import pytest
from ork_messages import PUBLISHED, their_messages

import robot_vision.msg
import robot_vision.srv


@pytest.fixture(scope="module")
def theirs(tmp_path_factory):
    return their_messages(tmp_path_factory.mktemp("ork"))


@pytest.mark.parametrize("name", PUBLISHED)
def test_md5_sums(theirs, name):
    modules = (theirs.srv, robot_vision.srv) if name.startswith("Get") else None
    their_module, our_module = modules or (theirs.msg, robot_vision.msg)
    assert getattr(their_module, name)._md5sum == PUBLISHED[name]
    assert getattr(our_module, name)._md5sum == PUBLISHED[name]


def test_what_goes_over_the_wire(theirs):
    """The bytes of one are the other's: names of fields are not in the sums of embedded types."""
    for name in PUBLISHED:
        if not name.startswith("Get"):
            ours, their_kind = getattr(robot_vision.msg, name), getattr(theirs.msg, name)
            assert ours.__slots__ == their_kind.__slots__
            their_types = [
                kind.replace("object_recognition_msgs", "robot_vision")
                for kind in their_kind._slot_types
            ]
            assert ours._slot_types == their_types
