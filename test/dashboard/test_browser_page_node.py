"""The dashboard's page: who gets in, what it loads, how it is arranged, what it survives."""

import os
import signal

import numpy as np
import pytest
import rospy
import support
from dashboard_node import Dashboard
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from frames import message
from pattern_camera import PatternCamera, located
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import Image, RegionOfInterest
from std_msgs.msg import Header

from robot_vision.msg import Detection, DetectionArray, TrackState, TrackStateArray
from robot_vision.ros.messages import region_of

pytest_plugins = ["browser", "dashboards"]  # their fixtures
MAX_TRAFFIC = 150e3  # bytes of the whole page as it comes over the net
SCRIPT = '<img src=x onerror="window.hacked=1"><script>window.hacked=1</script>'
OPEN = (
    "document.body.dataset.state === 'open' && robotVision.graph"
    " && robotVision.panels.tabs.size > 8"
)
KEYS = "robotVision.tiles.list().map((one) => one.key)"


@pytest.fixture(scope="module")
def cameras(master):
    made = [PatternCamera(name, located(320, 240)) for name in ("left", "middle", "right")]
    yield made
    for camera in made:
        camera.close()


def opened(page, dashboard):
    """The page, when it shows the images of the cameras."""
    page.open(dashboard.address)
    page.wait(f"{OPEN} && {KEYS}.length >= 3")
    return page


@pytest.fixture
def view(page, dashboard, cameras):
    return opened(page, dashboard)


def test_without_the_right_token_there_is_no_page(page, dashboard, cameras):
    page.expected.append("403")
    for address in (dashboard.origin + "/", dashboard.origin + "/?token=wrong"):
        page.open(address)
        assert "address" in page.text() and not page.value("Boolean(window.robotVision)")
    page.open(dashboard.origin + "/page/main.js")
    assert "import" not in page.text()


def test_the_page_is_small_and_all_of_it_comes_from_the_node(
    browser_with_traffic, dashboard, cameras
):
    view = opened(browser_with_traffic.page(), dashboard)
    view.wait("performance.now() > 1000")
    addresses, size = view.traffic()
    assert f"{dashboard.origin}/page/main.js" in addresses
    own = (dashboard.origin, dashboard.origin.replace("http:", "ws:"), "data:", "blob:")
    assert [address for address in addresses if not address.startswith(own)] == []
    assert 10e3 < size < MAX_TRAFFIC


def test_the_arrangement_is_kept(view):
    before = view.value(KEYS)
    view.keys("\ue014")  # the right arrow selects the first image
    view.wait("robotVision.tiles.selected?.key === arguments[0]", before[0])
    view.run(
        "document.dispatchEvent(new KeyboardEvent('keydown',"
        " {key: 'ArrowRight', altKey: true, bubbles: true}));"
    )
    view.wait(f"{KEYS}[1] === arguments[0]", before[0])
    view.keys("+")
    view.wait("document.querySelectorAll('.tile.double').length === 1")
    view.run("robotVision.tiles.hide(robotVision.tiles.list()[2]);")
    after = view.value(KEYS)
    assert set(after) < set(before) and after[1] == before[0]
    view.reload()
    view.wait(f"{OPEN} && {KEYS}.length === arguments[0]", len(after))
    assert view.value(KEYS) == after
    assert view.count(".tile.double") == 1


def test_the_keyboard_is_enough(view):
    view.keys("l")
    view.wait("document.getElementById('panel').dataset.tool === 'log'")
    view.run("document.activeElement.blur();")
    view.keys("\ue00c")  # Escape
    view.wait("document.getElementById('panel').hidden")
    view.keys("?")
    view.wait_for_text("Keyboard", "dialog")
    view.keys("\ue00c")
    view.wait("!document.querySelector('dialog[open]')")
    view.run("document.activeElement.blur();")
    view.keys("\ue014")
    view.wait("Boolean(robotVision.tiles.selected)")
    view.keys("\ue007")  # Enter
    view.wait("document.querySelector('.tile.enlarged')")
    view.keys("\ue00c")
    view.wait("!document.querySelector('.tile.enlarged')")


def test_a_phone_scrolls_down_only(view):
    view.size(390, 844, touch=True, scale=2)
    tools = view.value("[...robotVision.panels.tabs.keys()]")
    assert {"parameters", "select", "color", "faces", "bags", "log", "graph"} <= set(tools)
    for name in ["", *tools]:
        if name:
            view.run("robotVision.panels.open(arguments[0]);", name)
        wide = view.value(
            "[document.scrollingElement, document.getElementById('main'),"
            " ...document.querySelectorAll('.panel-body')]"
            ".filter((one) => one.scrollWidth > one.clientWidth + 1)"
            ".map((one) => `${one.id} ${one.scrollWidth} of ${one.clientWidth}`)"
        )
        assert not wide, (name, wide)


def test_it_is_dark_or_light_as_the_system_is_until_somebody_chooses(view):
    def brightness():
        return view.screenshot()[300:700].mean()

    view.scheme("dark")
    view.reload()
    view.wait(OPEN)
    dark = view.value("getComputedStyle(document.body).backgroundColor")
    view.scheme("light")
    view.reload()
    view.wait(OPEN)
    light = view.value("getComputedStyle(document.body).backgroundColor")
    mean = [np.mean([int(n) for n in one.strip("rgb()").split(",")]) for one in (dark, light)]
    assert mean[0] < 60 and mean[1] > 200
    view.click('[data-test="theme"]')
    view.wait("getComputedStyle(document.body).backgroundColor === arguments[0]", dark)
    view.reload()
    view.wait(OPEN)
    view.wait("getComputedStyle(document.body).backgroundColor === arguments[0]", dark)


class Writer:
    """Others who write script wherever they may write."""

    def __init__(self):
        self._subscriber = rospy.Subscriber("/test/select", RegionOfInterest, lambda _: None)
        kinds = {"/rosout": Log, "/diagnostics": DiagnosticArray, "/test/state": TrackStateArray}
        kinds["/test/objects"] = DetectionArray
        self._publishers = {
            name: rospy.Publisher(name, kind, queue_size=5) for name, kind in kinds.items()
        }

    def write(self):
        header = Header(stamp=rospy.Time.now())
        status = DiagnosticStatus(name="test: frames", level=2, message=SCRIPT)
        found = Detection(label=SCRIPT, id=1, score=0.5, box=region_of((20, 20, 50, 50)))
        for name, sent in {
            "/rosout": Log(header=header, level=8, name=SCRIPT, msg=SCRIPT, function=SCRIPT),
            "/diagnostics": DiagnosticArray(header=header, status=[status]),
            "/test/state": TrackStateArray(header, [TrackState(id=1, label=SCRIPT, state=1)]),
            "/test/objects": DetectionArray(header, 320, 240, [found]),
        }.items():
            self._publishers[name].publish(sent)

    def close(self):
        self._subscriber.unregister()
        for publisher in self._publishers.values():
            publisher.unregister()


@pytest.mark.parametrize("tool, place", [("log", "log"), ("select", "object"), ("", "state-words")])
def test_what_others_write_is_text(view, tool, place):
    """Lines and nodes of the log, names of what is followed, states of nodes."""
    writer = Writer()
    try:
        if tool:
            view.run("robotVision.panels.open(arguments[0]);", tool)

        def is_told():
            writer.write()
            return view.value(
                "[...document.querySelectorAll(`[data-test=${arguments[0]}]`)]"
                ".some((one) => one.textContent.includes(arguments[1]))",
                place,
                SCRIPT,
            )

        support.wait_for(is_told, f"what was written, in {place}")
        assert view.count("img[src='x'], #panel script, #main script") == 0
        assert not view.value("window.hacked")
    finally:
        writer.close()


def test_two_hundred_topics_are_listed_and_images_go_on(view, cameras):
    many = [rospy.Publisher(f"/many/image_{n}", Image, queue_size=1) for n in range(200)]
    try:
        view.wait(
            "robotVision.graph.topics.filter((one) => one.name.startsWith('/many/')).length === 200"
        )
        view.click('[data-test="add-image"]')
        view.wait("document.querySelectorAll('.menu-item').length >= 200")
        view.keys("image_177")
        item = "[...document.querySelectorAll('.menu-item')].filter((one) => !one.hidden)"
        view.wait(f"{item}.length === 1")
        view.run(f"{item}[0].click();")
        many[177].publish(message(located(32, 24), "bgr8"))

        def is_shown():
            many[177].publish(message(located(32, 24), "bgr8"))
            return view.value(
                "robotVision.tiles.list()"
                ".some((one) => one.image === '/many/image_177' && one.size[0])"
            )

        support.wait_for(is_shown, "the image of the chosen topic")
        drawn = view.value("Number(document.body.dataset.frames)")
        view.wait("Number(document.body.dataset.frames) > arguments[0] + 9", drawn)
    finally:
        for publisher in many:
            publisher.unregister()


GEOMETRY = [  # expression on /page/geometry.js, its value
    (
        "toImage({x: 60, y: 45}, {left: 10, top: 20, width: 100, height: 50}, [640, 480])",
        {"x": 320, "y": 240},
    ),
    (
        "toImage({x: -5, y: 999}, {left: 0, top: 0, width: 10, height: 10}, [640, 480])",
        {"x": 0, "y": 480},
    ),
    ("pixelAt({x: 640, y: 0.99}, [640, 480])", {"x": 639, "y": 0}),
    (
        "regionBetween({x: 20.5, y: 9}, {x: 10.2, y: 3.9}, [640, 480])",
        {"x": 10, "y": 3, "width": 11, "height": 7},
    ),
    (
        "regionBetween({x: 0, y: 0}, {x: 0, y: 0}, [1, 1])",
        {"x": 0, "y": 0, "width": 1, "height": 1},
    ),
]
LAYOUT = [
    ("moved(['a', 'b', 'c'], 'a', 2)", ["b", "c", "a"]),
    ("moved(['a', 'b', 'c'], 'c', 0)", ["c", "a", "b"]),
    ("moved(['a', 'b'], 'a', 99)", ["b", "a"]),
    ("arrangement({width: 390, height: 800, gap: 10}, 9, 4 / 3)", {"columns": 1, "width": 390}),
    ("arrangement({width: 1200, height: 900, gap: 10}, 1, 4 / 3).columns", 1),
    ("arrangement({width: 1200, height: 700, gap: 10}, 4, 4 / 3).columns", 2),
    ("neighbor([{x: 0, y: 0}, {x: 10, y: 0}, {x: 0, y: 10}], 0, 'ArrowRight')", 1),
    ("neighbor([{x: 0, y: 0}, {x: 10, y: 0}, {x: 0, y: 10}], 0, 'ArrowDown')", 2),
    ("neighbor([{x: 0, y: 0}, {x: 10, y: 0}, {x: 0, y: 10}], 0, 'ArrowLeft')", -1),
]
COLORS = [
    ("isHue('hsv', 0)", True),
    ("isHue('lab', 0)", False),
    ("cssColor('bgr', [10, 20, 30])", "rgb(30, 20, 10)"),
    ("cssColor('hsv', [60, 255, 255])", "hsl(120, 100.0%, 50.0%)"),
    ("cssColor('hsv', [0, 0, 255])", "hsl(0, 0.0%, 100.0%)"),
    ("cssColor('ycrcb', [77, 128, 128])", "rgb(77, 77, 77)"),
]
PALE = {"low": [12, 100, 100], "high": [32, 255, 255]}
COLORS += [  # a range is made to hold a colour; a hue is left, as it goes round
    (
        f"holding('hsv', {PALE}, [22, 48, 162])",
        {"space": "hsv", "low": [12, 28, 100], "high": [32, 255, 255], "widened": True},
    ),
    (f"holding('hsv', {PALE}, [22, 148, 162]).widened", False),
    (f"holding('hsv', {PALE}, [40, 100, 255]).widened", False),
    (f"holding('hsv', {PALE}, [22, 3, 255]).low[1]", 0),
    ("holding('bgr', {low: [0, 0, 0], high: [9, 9, 9]}, [250, 9, 0]).high", [255, 9, 9]),
]
DETECTIONS = "() => 'robot_vision/DetectionArray'"
OVERLAYS = [
    (
        f"chooseOverlays(['/a/detections', '/a/objects'], {DETECTIONS}).map((one) => one.topic)",
        ["/a/objects"],
    ),
    (
        f"chooseOverlays(['/a/detections', '/b/objects'], {DETECTIONS}).map((one) => one.topic)",
        ["/a/detections", "/b/objects"],
    ),
    (f"chooseOverlays(['/a/detections'], {DETECTIONS}).length", 1),
    ("chooseOverlays(['/a/detections'], () => 'std_msgs/String').length", 0),
]
FACES = "{type: 'robot_vision/DetectionArray', data: {detections: [%s]}}"
NAMES = (
    "drawIdentities({label: (text, {x}) => (told = [...(told || []), [text, x]])}, {identities: ["
    "{id: %d, name: 'Ada', known: true, distance: 0.25}]}, [" + FACES + "]) || told"
)
FACE_4 = "{id: 4, box: {x_offset: 40, y_offset: 0}}"
FACE_7 = "{id: 7, box: {x_offset: 70, y_offset: 0}}"
IDENTITIES = [  # a name is never that of another face
    (NAMES % (7, f"{FACE_4}, {FACE_7}"), [["Ada  0.25", 70]]),
    (NAMES % (3, f"{FACE_4}, {FACE_7}"), None),
    (NAMES % (-1, f"{FACE_4}, {FACE_7}"), [["Ada  0.25", 40]]),
    (NAMES % (-1, ""), None),
]
# A pen that tells its calls, each with the style of the line, or the words.
PEN = (
    "new Proxy({}, {get: (_, name) => (first, color, style) =>"
    " (told ||= []).push([name, style ?? first])})"
)
SHAPE = (
    f"drawDetections({PEN}, {{detections: [{{box: {{width: 9, height: 9}}, label: 'a', id: -1,"
    " predicted: false, outline: [{x: 0, y: 0}, {x: 9, y: 0}, {x: 5, y: 9}], %s}]}, []) || told[0]"
)
FILLED = ["polygon", {"dashed": False, "fill": True}]
MASKS = [
    (SHAPE % "mask: ''", ["polygon", {"dashed": False, "fill": False}]),
    (SHAPE % "mask: 'AP8='", FILLED),
    (SHAPE % "mask: null, _cut: {mask: 20000}", FILLED),
    (SHAPE % "mask: null, _cut: {mask: 20000, outline: 9}", ["box", {"dashed": False}]),
]
# Where the middle is of what a pen has painted.
PAINTED = (
    "Pen && ((told = new OffscreenCanvas(32, 32).getContext('2d')), new m.Pen(told,"
    " {scale: 1, ratio: 1, size: [32, 32]}).%s, told.getImageData(0, 0, 32, 32).data.reduce("
    "([n, x, y], a, i) => (i & 3) < 3 ? [n, x, y] : [n + a, x + a * (((i >> 2) & 31) + 0.5),"
    " y + a * ((i >> 7) + 0.5)], [0, 0, 0])"
    ".map((sum, _, all) => Number((sum / all[0]).toFixed(1))).slice(1))"
)
POINTS = "[{x: 10, y: 5}, {x: 13, y: 5}, {x: 13, y: 8}, {x: 10, y: 8}]"
PLACES = [  # points are counted from the middle of the first pixel, boxes from its corner
    (PAINTED % "box({x_offset: 10, y_offset: 5, width: 4, height: 4}, '#fff')", [12, 7]),
    (PAINTED % f"polygon({POINTS}, '#fff')", [12, 7]),
    (PAINTED % f"polygon({POINTS}, '#fff', {{origin: 0}})", [11.5, 6.5]),
    (PAINTED % "line({x: 10, y: 9}, {x: 14, y: 9}, '#fff')", [12.5, 9.5]),
    (PAINTED % "dots([{x: 12, y: 9}], '#fff')", [12.5, 9.5]),
    (PAINTED % "dots([{x: 12, y: 9}], '#fff', 4, 0)", [12, 9]),
    (PAINTED % "circle({x: 12, y: 9}, 5, '#fff')", [12.5, 9.5]),
]
CONTOUR = "{outline: [], box: {}, label: '', hole: false, depth: 0, %s}"
CONTOURS = f"drawContours({PEN}, {{contours: [{CONTOUR}, {CONTOUR}], %s}}) || told"
LINES = [["polygon", {"dashed": False, "width": 1.5, "open": cut}] for cut in (False, True)]
PARTLY = "contours are drawn whole"
CUT = [  # what did not come whole is not closed, and told
    (CONTOURS % ("", "", ""), [LINES[0], LINES[0]]),
    (
        CONTOURS % ("", "_cut: {outline: 99}", ""),
        [LINES[0], LINES[1], ["corner", f"1 of 2 {PARTLY}"]],
    ),
    (
        CONTOURS % ("", "", "_cut: {contours: 70}"),
        [LINES[0], LINES[0], ["corner", f"2 of 70 {PARTLY}"]],
    ),
    (
        f"drawFlow({PEN}, {{points: [], velocities: [], _cut: {{points: 7}}}}) || told",
        [["corner", "0 of 7 points are drawn"]],
    ),
]
STAMPED = (
    "Streams.prototype.openMessages.call({messages: new Map(), app: {connection: {channel:"
    " (kind, fields, receive) => setTimeout(() => receive({header: {stamp: %s}}, {stamp: 7.5}))}}},"
    " '/x', {onMessage: (stamp) => (told = stamp)}) &&"
    " new Promise((done) => setTimeout(() => done(told)))"
)
STAMPS = [(STAMPED % "7.5", 7.5), (STAMPED % "0", 7.5)]  # of cameras that give none as well
# The channels that are closed when the width has changed and these have given an image.
RESIZED = (
    "Streams && (async () => { const channels = []; told = [];"
    " const channel = (_, {width}, onData) =>"
    " (channels.push(onData), () => told.push(width));"
    " const app = {connection: {channel}, storage: {get: () => 80}};"
    " const listener = {width: 320, onFrame() {}, onError() {}};"
    " const {resize} = new m.Streams(app).openImage('/x', listener);"
    " resize(640);"
    " const canvas = new OffscreenCanvas(4, 3); canvas.getContext('2d');"
    " const payload = await canvas.convertToBlob({type: 'image/jpeg'});"
    " for (const one of %s) await channels[one]({header: {kind: 1}, payload});"
    " return told; })()"
)
STAMPS += [(RESIZED % "[0]", []), (RESIZED % "[0, 1]", [320]), (RESIZED % "[1]", [320])]
WATCHED = "[{name: '/t', publishers: ['/a'], subscribers: ['/me']}]"
GRAPH = [
    (f"shownTopics({WATCHED}, false, '/me').length", 0),
    (f"shownTopics({WATCHED}, false, '/other').length", 1),
    (f"shownTopics({WATCHED}, true, '/me').length", 1),
]
# Images that came to a dashboard whose clock shows 9000 s, and were drawn so long ago, ms.
TILE = (
    "problemOf({view: {drawn: {header: {received: %d}}, isOpen: true,"
    " times: [%s].map((ago) => performance.now() - ago)}, image: '/i', error: '%s', openedAt: -1e6,"
    " failedAt: performance.now() - %d, tiles: {isPublished: () => true},"
    " app: {connection: {state: 'open', serverTime: () => 9000}}})"
)
PROBLEMS = [
    (TILE % (9000, "0", "why", 0), "why"),
    (TILE % (9000, "0", "why", 60000), ""),  # images are drawn again
    (TILE % (9000, "0", "", 0), ""),
    (TILE % (1800, "4000", "", 0), "No image for 7200 s."),  # the only one, of long ago
    (TILE % (1800, "30, 0", "", 0), ""),  # they come, whatever the clocks show
    (TILE % (9000, "9000, 7000", "", 0), "No image for 7 s."),
]
# How many images were drawn of those that the dashboard had at these times.
DRAWN = (
    "ImageView && (() => { const app = {connection: {serverTime: () => 9},"
    " statistics: {add() {}}}; const view = {times: [], feeds: [], app};"
    " for (const received of %s)"
    " m.ImageView.prototype.count.call(view, {header: {received}}, 0);"
    " return view.times.length; })()"
)
IMAGES = [(DRAWN % "[5, 6]", 2), (DRAWN % "[5, 5]", 1)]  # the same in another size is none
PUSHED = (
    "Connection.prototype.pushed.call({channels: new Map([[3, {onError: (text) => told = text}]])},"
    " 'channel_error', {channel: %d, text: 'why %d'}) || told"
)
ERRORS = [(PUSHED % (3, 3), "why 3"), (PUSHED % (4, 4), None)]
PING = (  # when the server has said something once, at these times after it, ms
    "Connection && ((one) => { const now = performance.now();"
    " one.socket = {close: () => (told = 'lost')}; one.state = 'open';"
    " one.receive(one.socket, '{}');"
    " for (const later of %s) { performance.now = () => now + later; one.ping(); }"
    " delete performance.now; clearTimeout(one.timer); one.socket = one.state = null;"
    " return told; })(new m.Connection(''))"
)
PINGS = [  # timers that come late, as those of hidden pages, are no silence of the server
    (PING % "[60e3]", None),
    (PING % "[60e3, 76e3]", None),
    (PING % "[60e3, 78e3]", "lost"),
]
RECEIVED = (
    "Channel.prototype.receive.call({number: 3, onData: () => (told = ['data']),"
    " onError: (text) => (told = [text]), connection: {send: ({op, seq}) => told.push(op, seq)}},"
    " %s, {seq: 5}).then(() => told)"
)
CHANNELS = [  # a message that the node could not read is none, and acknowledged all the same
    (RECEIVED % "{_error: 'why', _type: 'a/B'}", ["why", "ack", 5]),
    (RECEIVED % "{_type: 'a/B'}", ["data", "ack", 5]),
]
OFFERS = (
    "offers(Object.entries(%s).map(([name, type]) => ({name, publishers: ['/a'],"
    " type: `sensor_msgs/${type}`}))).%s.map(({key, beside}) => [key, ...beside])"
)
EYE = (
    "{'/a/image': 'Image', '/a/image/compressed': 'CompressedImage',"
    " '/a/camera_info': 'CameraInfo'}"
)
BAGS = [  # of images the node chooses the form, and each topic can be had as it is
    (OFFERS % (EYE, "first"), [["images:/a/image", "/a/camera_info"]]),
    (OFFERS % (EYE, "others"), [["/a/camera_info"], ["/a/image"], ["/a/image/compressed"]]),
    ("requested(['images:/a', '/a', '/b'])", {"images": ["/a"], "topics": ["/a", "/b"]}),
    ("isWhole('stopped after 10 s, as wanted')", True),
    ("isWhole('stopped; nothing has come on /a')", False),
    ("isWhole('failed: the disk is full')", False),
]
YEAR_OF = {"12.3": "2023", "0": "2023", "1.4e9": "2014"}  # of a simulator, of none, of a robot
ROW = "bagRow({name: 'a', start: %s, changed: 1.7e9, size: 1, duration: 1, topics: []}).innerText"
YEARS = [(f"{ROW % start}.match(/20\\d\\d/)[0]", year) for start, year in YEAR_OF.items()]
LINE = "rowOf({level: 2, stamp: %s, node: '', text: ''}).querySelector('time').innerText"
LINES_OF_LOG = [
    (LINE % "12.3", "12.300 s"),
    (f"{LINE % '1.7e9 + 0.25'}.slice(-7)", ":20.250"),
]
SCALES = [
    ("shortNumber(2147483647)", "2147483647"),
    ("shortNumber(0.1 + 0.2)", "0.3"),
    ("shortNumber(null)", ""),
    ("sameValue(1234567890, 1234567891)", False),
    ("sameValue(0.1 + 0.2, 0.3)", True),
    ("sameValue(3, 3.000000000001)", True),
]
# The frames in which points are drawn of a cloud that changes its frame, and what is closed then.
CLOUD = (
    "SceneTopics && (() => { const opened = []; told = [];"
    " const channel = (op, _, onData) => (opened.push(onData), () => told.push(op));"
    " const view = {setPoints: (_, frame) => told.push(frame), remove() {}};"
    " const topics = new m.SceneTopics({connection: {channel}}, view);"
    " topics.show({name: '/cloud', type: m.POINTS});"
    " for (const frame_id of ['a', '/b'])"
    " { opened[0]({header: {frame_id}}); opened[1]({payload: 1}); }"
    " topics.hide('/cloud'); return told; })()"
)
PARTS = {
    "scene_topics": [(CLOUD, ["a", "b", "messages", "points"])],
    "bag_offers": BAGS,
    "bag_rows": YEARS,
    "log_rows": LINES_OF_LOG,
    "parameter_scale": SCALES,
    "image_view": IMAGES,
    "channels": CHANNELS,
    "tile_problem": PROBLEMS,
    "connection": ERRORS + PINGS,
    "geometry": GEOMETRY,
    "layout": LAYOUT,
    "color_spaces": COLORS,
    "overlay": OVERLAYS,
    "overlay_detections": IDENTITIES + MASKS,
    "overlay_features": CUT,
    "overlay_pen": PLACES,
    "streams": STAMPS,
    "graph_layout": GRAPH,
}


def test_the_parts_that_know_no_page_are_right(view):
    for module, table in PARTS.items():
        for expression, expected in table:
            told = view.run(
                f"let told; const m = await import('/page/{module}.js'); return m.{expression};"
            )
            assert told == expected, expression


def test_the_page_goes_on_when_its_node_is_killed_and_started_again(
    page,
    cameras,
    start,
    tmp_path,
):
    page.expected += ["WebSocket", "ERR_CONNECTION", "Failed to load resource"]
    mine = Dashboard(start)
    page.open(mine.address)
    page.wait(f"{OPEN} && Number(document.body.dataset.frames) > 3")
    os.kill(mine.process.pid, signal.SIGKILL)
    page.wait("document.body.dataset.state === 'closed'")
    page.wait_for_text("connection to the dashboard is lost", "#bar")
    mine.begin()
    page.wait(OPEN)
    drawn = page.value("Number(document.body.dataset.frames)")
    page.wait("Number(document.body.dataset.frames) > arguments[0] + 3", drawn)
    assert page.value("document.getElementById('bar').hidden")


def test_images_come_back_when_the_master_was_restarted(page, start):
    page.expected += ["WebSocket", "ERR_CONNECTION"]  # at the end, when the node has ended
    master = support.Master(start)
    mine = Dashboard(start, env=master.env)
    start("camera_node", "__name:=room", "_source:=synthetic", env=master.env)
    page.open(mine.address)
    tile = "robotVision.tiles.list().find((one) => one.node === '/room')"
    page.wait(f"{OPEN} && {tile}?.size[0]")
    bar = "document.getElementById('bar')"
    assert page.value(f"{bar}.hidden")
    master.end()
    page.wait(f"!{bar}.hidden && {bar}.innerText.includes('does not answer')")
    assert "Try now" not in page.value(f"{bar}.innerText")
    master.begin()
    page.wait(f"{bar}.hidden")
    support.wait_for(
        lambda: any(topic == "/room/image_raw" for topic, _ in master.api.getPublishedTopics("/")),
        "the camera",
    )
    page.wait("robotVision.graph.nodes.some((one) => one.name === '/room')")
    drawn = page.value("Number(document.body.dataset.frames)")
    page.wait("Number(document.body.dataset.frames) > arguments[0] + 20", drawn)
