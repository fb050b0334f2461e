"""Boxes of 40 x 60 px, and a BoxTracker that has seen some."""

import robot_vision as rv

STEP = 1.0 / 8.0  # s from one result to the next


def tracker(**values):
    params = rv.BoxTrackerParams()
    for name, value in values.items():
        setattr(params, name, value)
    return rv.BoxTracker(params)


def at(x, y=100.0, width=40.0, height=60.0):
    return x, y, x + width, y + height


def sure(box, class_id=0):
    return class_id, 0.9, box


def unsure(box, class_id=0):
    return class_id, 0.3, box


def shown(tracks):
    return {track.id: track.box for track in tracks}


def started(made, boxes, count=4):
    """Has a tracker see boxes at rest in some results; the time of the next one."""
    for number in range(count):
        made.update(number * STEP, [sure(box) for box in boxes])
    return count * STEP
