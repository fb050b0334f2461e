"""The sessions that are told of something."""

import types

from robot_vision.dashboard.watchers import Watchers


class Session:
    id = 7

    def __init__(self):
        self.pushed, self.at_end = [], []
        self.on_close = self.at_end.append

    def push(self, kind, data):
        self.pushed.append((kind, data))


def test_each_is_told_until_it_leaves():
    watchers, session, other = Watchers(), Session(), types.SimpleNamespace(id=8)
    other.push, other.on_close = Session().push, print
    watchers.add(session)
    watchers.add(session)
    watchers.add(other)
    watchers.push("news", {"x": 1})
    watchers.remove(session)
    watchers.push("news", {"x": 2})
    assert session.pushed == [("news", {"x": 1})] and len(watchers) == 1


def test_the_end_of_the_last_one_is_told_once():
    empty = []
    watchers, session = Watchers(lambda: empty.append(1)), Session()
    watchers.add(session)
    session.at_end[0]()
    watchers.remove(session)
    assert empty == [1] and len(watchers) == 0


def test_who_comes_again_and_again_leaves_nothing_behind():
    watchers, session = Watchers(), Session()
    for _ in range(20):
        watchers.add(session)
        watchers.remove(session)
    watchers.add(session)
    assert len(session.at_end) == 1
    session.at_end[0]()
    assert len(watchers) == 0
