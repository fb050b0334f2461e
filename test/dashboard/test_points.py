"""Points and colours of clouds, whatever their layout."""

import threading

import numpy as np
import pytest
import support
from sensor_msgs.msg import PointCloud2, PointField
from slow_peer import Peer

from robot_vision.dashboard import outbox
from robot_vision.dashboard.channels import Channel
from robot_vision.dashboard.cloud_points import GRAY, points_of
from robot_vision.dashboard.message_topics import RawMessage
from robot_vision.dashboard.point_feature import CLOUD, MAX_MAKING, _Viewer

FLOAT = {"f4": PointField.FLOAT32, "f8": PointField.FLOAT64, "i2": PointField.INT16}
MANY = 10**6


def cloud(xyz, colors=None, order="xyz", kind="f4", big=False, width=0, pad=0, gap=0, rgb="rgb"):
    """A cloud of (n, 3) points with (n, 3) uint8 colours, red first.

    Args:
        order: The names of the coordinates as they follow each other.
        width: That of an organized cloud.
        pad: Bytes behind each row.
        gap: Bytes behind each coordinate.
    """
    end = ">" if big else "<"
    fields, message = [], PointCloud2(is_bigendian=big)
    offset = 0
    for name in order:
        fields.append((name, end + kind, offset))
        message.fields.append(PointField(name, offset, FLOAT[kind], 1))
        offset += np.dtype(kind).itemsize + gap
    if colors is not None:
        fields.append((rgb, end + "u4", offset))
        datatype = PointField.FLOAT32 if rgb == "rgb" else PointField.UINT32
        message.fields.append(PointField(rgb, offset, datatype, 1))
        offset += 4
    names, formats, offsets = zip(*fields)
    layout = np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": offset})
    records = np.zeros(len(xyz), layout)
    for at, name in enumerate("xyz"):
        records[name] = xyz[:, at]
    if colors is not None:
        red, green, blue = np.uint32(colors).T
        records[rgb] = red << 16 | green << 8 | blue
    message.width = width or len(xyz)
    message.height = len(xyz) // message.width
    message.point_step = offset
    message.row_step = message.width * offset + pad
    rows = records.reshape(message.height, message.width)
    message.data = b"".join(row.tobytes() + b"\xee" * pad for row in rows)
    return message


XYZ = np.arange(72, dtype=np.float32).reshape(24, 3) - 30
COLORS = np.arange(72, dtype=np.uint8).reshape(24, 3) * 3


@pytest.mark.parametrize(
    "layout",
    [
        {},
        {"order": "zxy"},
        {"order": "yzx", "gap": 5},
        {"kind": "f8"},
        {"kind": "i2"},
        {"big": True},
        {"big": True, "kind": "f8", "gap": 3},
        {"width": 6},
        {"width": 6, "pad": 7},
        {"width": 1, "pad": 1},
        {"rgb": "rgba"},
        {"rgb": "rgba", "big": True},
    ],
)
def test_points_and_colors_are_those_of_the_cloud(layout):
    points = points_of(cloud(XYZ, COLORS, **layout), MANY)
    assert points.xyz.dtype == np.float32 and np.array_equal(points.xyz, XYZ)
    assert np.array_equal(points.colors[:, :3], COLORS) and (points.colors[:, 3] == 255).all()


def test_the_payload_has_all_coordinates_and_then_all_colors():
    payload = points_of(cloud(XYZ, COLORS), MANY).payload()
    assert len(payload) == 24 * 16
    assert np.array_equal(np.frombuffer(payload, "<f4", 72).reshape(24, 3), XYZ)
    assert np.array_equal(
        np.frombuffer(payload, np.uint8, offset=288).reshape(24, 4)[:, :3], COLORS
    )


@pytest.mark.parametrize("count, step", [(24, 1), (23, 2), (12, 2), (11, 3), (5, 5), (1, 24)])
@pytest.mark.parametrize("layout", [{}, {"width": 4, "pad": 3}])
def test_of_more_points_than_wanted_every_nth_is_shown(count, step, layout):
    points = points_of(cloud(XYZ, COLORS, **layout), count)
    assert np.array_equal(points.xyz, XYZ[::step])
    assert np.array_equal(points.colors[:, :3], COLORS[::step])
    assert len(points.xyz) <= count


def test_points_that_are_not_finite_are_left_out():
    xyz = XYZ.copy()
    xyz[3, 0], xyz[7, 2], xyz[9] = np.nan, np.inf, -np.inf
    points = points_of(cloud(xyz, COLORS), MANY)
    kept = np.isfinite(xyz).all(1)
    assert kept.sum() == 21
    assert np.array_equal(points.xyz, xyz[kept]) and np.array_equal(
        points.colors[:, :3], COLORS[kept]
    )


def test_points_beyond_float32_are_left_out():
    xyz = np.float64(XYZ)
    xyz[0, 0] = 1e300
    assert len(points_of(cloud(xyz, kind="f8"), MANY).xyz) == 23


def test_points_without_color_are_gray():
    assert (points_of(cloud(XYZ), MANY).colors == [GRAY, GRAY, GRAY, 255]).all()


def test_intensity_is_shown_as_gray():
    message = cloud(XYZ, order="xyz", gap=4)
    message.fields.append(PointField("intensity", 4, PointField.UINT16, 1))
    data = np.frombuffer(message.data, np.uint8).reshape(24, message.point_step).copy()
    data[:, 4] = np.arange(24)
    message.data = data.tobytes()
    gray = points_of(message, MANY).colors[:, 0]
    assert gray[0] == 55 and gray[-1] == 255 and (np.diff(gray.astype(int)) > 0).all()


@pytest.mark.parametrize("height, width", [(0, 0), (0, 5), (5, 0)])
def test_a_cloud_without_points_is_none(height, width):
    message = cloud(XYZ)
    message.height, message.width, message.data = height, width, b""
    points = points_of(message, MANY)
    assert points.payload() == b"" and points.xyz.shape == (0, 3) and points.colors.shape == (0, 4)


def test_row_step_may_be_missing_of_a_single_row():
    message = cloud(XYZ)
    message.row_step = 0
    assert np.array_equal(points_of(message, MANY).xyz, XYZ)


def changed(**values):
    message = cloud(XYZ, COLORS, width=6)
    for name, value in values.items():
        setattr(message, name, value)
    return message


def with_field(**values):
    message = cloud(XYZ, COLORS, width=6)
    for name, value in values.items():
        setattr(message.fields[3 if "rgb" in values.get("name", "") else 0], name, value)
    return message


@pytest.mark.parametrize(
    "message, words",
    [
        (changed(fields=[]), "no field x, only none"),
        (changed(fields=[PointField("\n<b>", 0, 7, 1)]), r"no field x, only \\n<b>"),
        (changed(fields=[PointField("x", 0, 7, 1)] * 1000), "has 1000 fields"),
        (changed(point_step=0), "point_step is 0"),
        (changed(point_step=2**32 - 1), "row_step is 96, must be at least 6\\*4294967295"),
        (changed(row_step=95), "row_step is 95, must be at least 6\\*16"),
        (changed(row_step=2**32 - 1), "6x4 points has 384 bytes, which is too few"),
        (changed(width=2**32 - 1, row_step=2**32 - 1), "row_step"),
        (changed(height=2**32 - 1), "which is too few"),
        (changed(data=b""), "has 0 bytes"),
        (changed(data=bytes(383)), "has 383 bytes"),
        (changed(row_step=0), "row_step is 0"),
        (with_field(offset=13), "ends at byte 17 of a point, which has 16"),
        (with_field(offset=2**32 - 1), "ends at byte 4294967299"),
        (with_field(datatype=0), "field 'x' of a cloud has the datatype 0, must be from 1 to 8"),
        (with_field(datatype=9), "datatype 9"),
        (with_field(name="rgb", datatype=8), "rgb of a cloud has the datatype 8, must have four"),
        (with_field(name="rgb", offset=14), "field 'rgb' of a cloud ends at byte 18"),
    ],
)
def test_a_hostile_cloud_is_refused_in_words(message, words):
    with pytest.raises(ValueError, match=words):
        points_of(message, MANY)


def test_a_large_organized_cloud_gives_as_many_points_as_wanted():
    xyz = np.random.default_rng(3).normal(size=(640 * 480, 3)).astype(np.float32)
    colors = np.random.default_rng(4).integers(0, 256, (640 * 480, 3), np.uint8)
    points = points_of(cloud(xyz, colors, width=640, pad=16, gap=1), 50000)
    step = -(-640 * 480 // 50000)
    assert np.array_equal(points.xyz, xyz[::step])
    assert np.array_equal(points.colors[:, :3], colors[::step])


def test_clouds_for_a_page_that_does_not_read_are_not_made_before_it_does(monkeypatch):
    monkeypatch.setattr(outbox, "MAX_PACED", 1 << 20)
    peer, making = Peer(), threading.Semaphore(0)
    can_send, able = _Viewer._can_send, set()
    monkeypatch.setattr(_Viewer, "_can_send", lambda one: can_send(one) and not able.add(one))
    raw = RawMessage(CLOUD, "", b"", 0.0, "/eye", cloud(np.ones((10000, 3), np.float32)))
    channels = [Channel(number, peer.outbox) for number in range(1, 41)]
    viewers = [_Viewer("/cloud", None, channel, 10000, making) for channel in channels]
    for channel, viewer in zip(channels, viewers):
        channel.on_ready(viewer.wake)
        viewer.offer(raw)
    support.wait_for(lambda: len(able) == len(viewers), "viewers that all have room so far")
    for _ in range(MAX_MAKING):
        making.release()
    support.wait_for(lambda: peer.outbox.is_full(lambda: None), "frames that wait")
    for _ in range(MAX_MAKING):  # until those that were begun are made
        assert making.acquire(timeout=support.DEADLINE)
    size = 10000 * 16 + 32
    waiting = sum(message.size for message in list(peer.outbox._messages.values()))
    waiting += size * sum(channel._newest is not None for channel in channels)
    assert 1 << 20 <= waiting <= (1 << 20) + MAX_MAKING * size
    for _ in range(MAX_MAKING):
        making.release()
    support.wait_for(lambda: peer.read_all() or len(peer.taken) == len(viewers), "all frames")
    for channel, viewer in zip(channels, viewers):
        channel.close()
        viewer.wake()
    peer.end()
