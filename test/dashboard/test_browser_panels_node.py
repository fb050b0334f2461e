"""Panels of the page, in a real browser, with nodes that the test plays and that may fail."""

import threading

import cv2
import numpy as np
import pytest
import support
from served import TOKEN, Served

from robot_vision.dashboard.channels import JPEG
from robot_vision.dashboard.fields import Field
from robot_vision.dashboard.operations import Operation

pytest_plugins = ["browser"]  # its fixtures
NODE, EYE = "/hsv_tracker", "/eye/image_raw"
HSV = {"h_low": 0, "s_low": 50, "v_low": 60, "h_high": 10, "s_high": 250, "v_high": 255}


class Anything(Field):
    """A field that may hold whatever the page sends, or be left out."""

    default = None

    def check(self, name, value):
        return value


FIELDS = (
    "node name values topic topics images channel space low high x y width quality level rate "
    "region label pictures index max_megabytes max_seconds root max_points"
)  # of all requests


def node(name, **more):
    told = {"name": name, "package_node": True, "publishes": [], "subscribes": [], "services": []}
    return {**told, "parameters": False, "status": None, **more}


def topic(name, **more):
    kind = "CameraInfo" if name.endswith("camera_info") else "Image"
    told = {"name": name, "type": f"sensor_msgs/{kind}", "image": kind == "Image"}
    return {**told, "publishers": ["/eye"], "subscribers": [], **more}


class Played:
    """A dashboard without ROS, whose operations answer what a test has said.

    Attributes:
        answers: What operations answer, by name: a function of the session and the fields.
        asked: The name and fields of each request so far.
        sessions: Those that have asked for the graph, as each page does first.
    """

    def __init__(self, nodes, views=(), topics=(EYE,), **answers):
        self.graph = {"time": 0, "problem": "", "nodes": nodes, "views": list(views)}
        self.graph["topics"] = [topic(name) for name in topics]
        self.answers = {"graph": self._graph, "image": self._image, **answers}
        self.asked = []
        self.sessions = []
        fields = {name: Anything() for name in FIELDS.split()}
        operations = [
            Operation(name, self._answer(name), "view", fields, beside=True)
            for name in self.answers
        ]
        self.served = Served(*operations)
        self.address = f"http://{self.served.host}/?token={TOKEN}"

    def _answer(self, name):
        def run(session, fields):
            given = {key: value for key, value in fields.items() if value is not None}
            self.asked.append((name, given))
            return self.answers[name](session, given)

        return run

    def count(self, name):
        return sum(asked == name for asked, _ in self.asked)

    def _graph(self, session, _fields):
        self.sessions.append(session)
        session.push("graph", self.graph)
        return {}

    def _image(self, session, fields):
        jpeg = cv2.imencode(".jpg", np.full((48, 64, 3), 128, np.uint8))[1].tobytes()
        session.channel(fields["channel"]).send_binary(JPEG, 1.0, 1.0, 64, 48, jpeg)
        return {}


@pytest.fixture
def play(page):
    """play(nodes, ...): a Played, which the page shows."""
    made = []

    def begin(*arguments, **answers):
        made.append(Played(*arguments, **answers))
        page.open(made[-1].address)
        page.wait("robotVision.graph && robotVision.panels.tabs.size > 8")
        return made[-1]

    yield begin
    page.front().browser.driver.get("about:blank")  # or the page would look for its server
    for one in made:
        one.served.server.close()


def open_tool(page, name):
    page.run("robotVision.panels.open(arguments[0]);", name)


class Tracker:
    """Plays an hsv_tracker with the colour red, or two of them.

    Attributes:
        all_values: The values of each, by its name.
        values: Those of the first one.
    """

    def __init__(self, play, *others, **answers):
        names = NODE, *others
        self.all_values = {name: {**HSV, "space": "hsv", "color": "red"} for name in names}
        self.values = self.all_values[NODE]
        self.fails = False
        view = {"title": "hsv_tracker", "image": EYE, "overlays": ["/x"], "processed": ""}
        self.played = play(
            [node(name, publishes=[f"{name}/mask"], parameters=True) for name in names],
            [{**view, "node": name} for name in names],
            color_names=lambda *_: {"names": ["red", "blue"], "shown": self.values["color"]},
            parameters=lambda _, fields: {"values": self.all_values[fields["node"]]},
            set_parameters=self._set,
            use_color=self._use,
            **answers,
            messages=lambda *_: {},
            close_parameters=lambda *_: {},
        )

    def _use(self, _session, fields):
        low, high = fields["low"], fields["high"]
        names = ("h_low", "s_low", "v_low", "h_high", "s_high", "v_high")
        values = dict(zip(names, [*low, *high]))
        return self._set(_session, {"node": fields["node"], "values": values})

    def _set(self, _session, fields):
        if self.fails:
            raise OSError("/hsv_tracker/set_parameters has not answered within 5 s")
        values = self.all_values[fields["node"]]
        values.update(fields["values"])
        return {"values": values, "refused": {}}


LIMIT = "document.querySelector('[data-test=range-1-low]')?.getAttribute('aria-valuenow')"


def raise_limit(page):
    """Moves the lower limit of the saturation by one."""
    page.run("document.querySelector('[data-test=range-1-low]').focus();")
    page.keys("\ue014")  # the right arrow


def test_colours_are_those_of_the_node_after_a_new_connection(page, play):
    tracker = Tracker(play)
    open_tool(page, "color")
    page.wait(f"{LIMIT} === '50'")
    tracker.values["s_low"] = 77
    page.run("robotVision.connection.socket.close();")
    page.wait(f"{LIMIT} === '77'")


def test_a_tracker_is_found_once_it_has_a_mask(page, play):
    played = Tracker(play).played
    one = played.graph["nodes"][0]
    mask, one["publishes"] = one["publishes"], []
    played.sessions[0].push("graph", played.graph)
    page.wait("robotVision.graph.nodes[0].publishes.length === 0")
    open_tool(page, "color")
    assert not page.value(LIMIT)
    one["publishes"] = mask
    played.sessions[0].push("graph", played.graph)
    page.wait(f"{LIMIT} === '50'")


def test_a_limit_that_was_not_taken_is_not_shown(page, play):
    tracker = Tracker(play)
    open_tool(page, "color")
    page.wait(f"{LIMIT} === '50'")
    tracker.fails = True
    raise_limit(page)
    page.wait_for_text("has not answered", '[data-test="color-answer"]')
    assert page.value(LIMIT) == "50"
    page.fill('[data-test="color-name"]', "blue")
    support.wait_for(lambda: tracker.played.count("set_parameters") == 1, "the request")
    page.wait("document.querySelector('[data-test=color-name]').value === 'red'")
    tracker.fails = False
    raise_limit(page)
    support.wait_for(lambda: tracker.values["s_low"] == 51, "the limit")


def test_the_answer_of_one_tracker_is_not_that_of_another(page, play):
    """Neither what it says late, nor what was to be set meanwhile."""
    tracker, answered = Tracker(play, "/other"), threading.Event()
    tracker.all_values["/other"]["s_low"] = 90
    use = tracker.played.answers["use_color"]

    def late(session, fields):
        answered.wait(support.DEADLINE)
        return use(session, fields)

    tracker.played.answers["use_color"] = late
    open_tool(page, "color")
    page.wait(f"{LIMIT} === '50'")
    raise_limit(page)
    support.wait_for(lambda: tracker.played.count("use_color") == 1, "the first limit")
    raise_limit(page)
    page.fill('[data-test="color-node"]', "/other")
    page.wait(f"{LIMIT} === '90'")
    answered.set()
    page.fill('[data-test="color-name"]', "blue")
    support.wait_for(lambda: tracker.played.count("set_parameters") == 1, "the next request")
    support.wait_for(lambda: tracker.values["s_low"] == 51, "the first tracker's limit")
    assert page.value(LIMIT) == "90"
    assert tracker.all_values["/other"]["s_low"] == 90
    assert tracker.played.count("use_color") == 1


def test_what_one_tracker_saves_late_leaves_undo_of_another(page, play):
    saved = threading.Event()

    def save(_session, _fields):
        saved.wait(support.DEADLINE)
        return {"message": "it is saved"}

    tracker = Tracker(play, "/other", save_parameters=save)
    other = tracker.all_values["/other"]
    other["s_low"] = 90
    open_tool(page, "color")
    page.wait(f"{LIMIT} === '50'")
    page.click('[data-test="color-save"]')
    support.wait_for(lambda: tracker.played.count("save_parameters") == 1, "the saving")
    page.fill('[data-test="color-node"]', "/other")
    page.wait(f"{LIMIT} === '90'")
    raise_limit(page)
    support.wait_for(lambda: other["s_low"] == 91, "the limit")
    saved.set()
    page.wait_for_text("it is saved", '[data-test="color-answer"]')
    page.click('[data-test="color-undo"]')
    support.wait_for(lambda: other["s_low"] == 90, "the limit before")


def test_enrolling_leaves_no_parameters_open(page, play):
    played = play(
        [node("/door", services=["/door/enroll"])],
        faces=lambda *_: {"people": []},
        parameters=lambda *_: {"values": {"enroll_timeout": 100.0}},
        close_parameters=lambda *_: {},
        enroll=lambda *_: {"message": "Ada is enrolled"},
    )
    open_tool(page, "faces")
    page.fill('[data-test="face-name"]', "Ada")
    page.click('[data-test="face-enroll"]')
    page.wait_for_text("Ada is enrolled", '[data-test="face-answer"]')
    assert played.count("parameters") == 1
    support.wait_for(lambda: played.count("close_parameters") == 1, "the end of the look")


@pytest.mark.parametrize("tool, asks", [("bags", "bags"), ("calibration",) * 2, ("faces",) * 2])
def test_a_panel_that_opens_before_the_connection_asks_once_it_is_there(page, play, tool, asks):
    answer = {"people": [], "bags": [], "unfinished": [], "recording": None, "topic": ""}
    answer.update(folder="/bags", free=1e9, max_megabytes=1)
    played = play([node("/door", services=["/door/enroll"])], **{asks: lambda *_: answer})
    page.run("robotVision.connection.state = 'connecting';")
    open_tool(page, tool)
    page.run("robotVision.connection.setState('open');")
    support.wait_for(lambda: played.count(asks) == 1, "the question")
    assert page.value("window.keptNotices") == []


def test_a_result_that_is_new_takes_the_place_of_the_one_before(page, play):
    result = {"lines": ["first"], "error": 0.3, "unsure": False, "advice": "", "yaml": "x"}
    settings = {"model": "plumb_bob"}
    state = {"topic": EYE, "settings": settings, "views": 20, "corners": [], "solving": False}
    state["result"] = result
    played = play([], calibration=lambda *_: state, close_calibration=lambda *_: {})
    open_tool(page, "calibration")
    page.wait_for_text("first", '[data-test="calibration-lines"]')
    result["lines"] = ["second"]
    played.sessions[0].push("calibration", state)
    page.wait_for_text("second", '[data-test="calibration-lines"]')


def test_the_details_of_a_topic_are_those_of_now(page, play):
    played = play([node("/eye", publishes=[EYE])], rate=lambda *_: {"rate": 5.0, "bandwidth": 1e3})
    played.graph["topics"][0]["subscribers"] = ["/ear"]
    details = '[data-test="graph-details"]'
    chosen = "document.querySelector(`[data-id='t${arguments[0]}']`)"

    def push():
        played.sessions[0].push("graph", played.graph)

    push()
    open_tool(page, "graph")
    page.wait(f"Boolean({chosen})", EYE)
    page.run(f"{chosen}.dispatchEvent(new MouseEvent('click', {{bubbles: true}}));", EYE)
    page.wait_for_text("/ear", details)
    page.run(
        "[...document.querySelectorAll('[data-test=graph-details] button')]"
        ".find((one) => one.textContent === 'Measure the rate').click();"
    )
    page.wait_for_text("5.0 Hz", details)
    played.graph["topics"][0]["subscribers"] = ["/nose"]
    push()
    page.wait_for_text("/nose", details)
    assert "5.0 Hz" in page.value(f"document.querySelector('{details}').innerText")
    played.graph["topics"] = []
    push()
    page.wait_for_text("It has gone.", details)


def test_what_came_once_comes_back_into_space_after_a_lost_context(page, play):
    pose = {"position": {"x": 0, "y": 0, "z": 1}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}

    def tell(session, fields):
        message = {"header": {"frame_id": "map"}, "pose": pose}
        session.channel(fields["channel"]).send_message(message, 1.0, 1.0)
        return {}

    def frames(session, fields):
        told = {"root": "map", "roots": ["map"], "frames": []}
        session.channel(fields["channel"]).send_message(told, 1.0, 1.0)
        return {}

    played = play([], messages=tell, frames=frames)
    played.graph["topics"].append(topic("/goal", type="geometry_msgs/PoseStamped"))
    played.sessions[0].push("graph", played.graph)
    open_tool(page, "scene3d")
    if page.count('[data-test="no-webgl"]'):
        pytest.skip("this chromium draws no WebGL")
    support.wait_for(lambda: played.count("messages") == 1, "the first request")
    page.run(
        "const scene = document.querySelector('[data-test=scene]');"
        "const lose = scene.getContext('webgl').getExtension('WEBGL_lose_context');"
        "scene.addEventListener('webglcontextlost', () => setTimeout(() => lose.restoreContext()));"
        "lose.loseContext();"
    )
    support.wait_for(lambda: played.count("messages") == 2, "the request after the loss")


ESCAPE = "\ue00c"
FOLLOWER = '[data-test="tile"][data-node="/object_tracker"]'


@pytest.fixture
def follower(page, play):
    """An object_tracker that is played, with the panel that selects what it follows."""
    name = "/object_tracker"
    view = {"node": name, "title": name, "image": EYE, "overlays": ["/x"], "processed": ""}
    played = play(
        [node(name, services=[f"{name}/select_object"])],
        [view],
        select_object=lambda *_: {"message": "followed"},
        messages=lambda *_: {},
    )
    open_tool(page, "select")
    page.wait("robotVision.tiles.list()[0]?.size[0] > 0")
    return played


def test_messages_that_the_node_cannot_read_are_told(page, follower):
    said = "another version of its type"

    def tell(session, fields):
        session.channel(fields["channel"]).send_message({"_error": said}, 1.0, 1.0)
        return {}

    follower.answers["messages"] = tell
    follower.graph["topics"] += [
        topic("/object_tracker/state", type="robot_vision/TrackStateArray"),
        topic("/x", type="robot_vision/DetectionArray"),
    ]
    follower.sessions[-1].push("graph", follower.graph)
    page.wait_for_text(said, '[data-test="follows-nothing"]')
    overlay = f"document.querySelector('{FOLLOWER} .overlay')"
    painted = "getContext('2d').getImageData(9, 12, 1, 1).data[3] > 0"  # the words in the corner
    page.wait(f"{overlay}.{painted}")


def test_escape_ends_a_tool_together_with_its_panel_and_after_an_enlarged_image(page, follower):
    page.run("robotVision.tiles.enlarge(robotVision.tiles.list()[0]);")
    page.keys(ESCAPE)
    page.wait("!document.querySelector('.tile.enlarged')")
    assert page.value("document.body.dataset.tool") == "select"
    assert not page.value("document.getElementById('panel').hidden")
    page.keys(ESCAPE)
    page.wait("document.getElementById('panel').hidden")
    assert page.value("document.body.dataset.tool") == ""


def test_escape_ends_a_drag_without_effect(page, follower):
    page.run("document.querySelector('[data-test=select-label]').focus();")
    left, top, width, height = page.box(f'{FOLLOWER} [data-test="image"]')
    # Away from the middle, where the tile says that no other image comes.
    begin, middle, end = ((left + part * width, top + part * height) for part in (0.1, 0.25, 0.3))
    page._mouse("begin", *begin)
    page._mouse("move", *middle)
    page.command("Input.dispatchKeyEvent", type="keyDown", key="Escape")
    page._mouse("move", *end)
    page._mouse("end", *end)
    assert not page.value("document.getElementById('panel').hidden")
    page.drag([middle, end, end])
    page.wait_for_text("followed", '[data-test="select-answer"]')
    (asked,) = [fields for name, fields in follower.asked if name == "select_object"]
    assert asked["region"]["x"] == 16 and follower.count("select_object") == 1


def test_a_second_finger_changes_nothing_of_a_drag(page, follower):
    page.size(900, 700, touch=True)
    left, top, width, height = page.box(f'{FOLLOWER} [data-test="image"]')
    begin, end, other = (
        {"x": left + part * width, "y": top + part * height, "id": number}
        for part, number in ((0.1, 0), (0.3, 0), (0.8, 1))
    )
    for count, fingers in enumerate(([end], [end, other]), 1):
        for kind, points in (("Start", [begin]), ("Move", [end]), ("Start", fingers), ("End", [])):
            page.command("Input.dispatchTouchEvent", type=f"touch{kind}", touchPoints=points)
        support.wait_for(lambda n=count: follower.count("select_object") == n, "what is selected")
    alone, both = (fields["region"] for name, fields in follower.asked if name == "select_object")
    assert alone == both and alone["width"] > 5


def test_a_drag_ends_though_its_node_goes_meanwhile(page, follower):
    left, top, width, height = page.box(f'{FOLLOWER} [data-test="image"]')
    begin, end = ((left + part * width, top + part * height) for part in (0.1, 0.3))
    services = "robotVision.graph.nodes[0].services.length"
    is_dragged = "robotVision.tiles.list()[0].view.layers.has('drag')"

    def offer(*names):
        follower.graph["nodes"][0]["services"] = names
        follower.sessions[-1].push("graph", follower.graph)
        page.wait(f"{services} === arguments[0]", len(names))

    known = follower.graph["nodes"][0]["services"]
    page._mouse("begin", *begin)
    page._mouse("move", *end)
    assert page.value(is_dragged)
    offer()
    page._mouse("end", *end)
    offer(*known)
    assert not page.value(is_dragged) and follower.count("select_object") == 0
    page.drag([begin, end, end])
    page.wait_for_text("followed", '[data-test="select-answer"]')


def parameter(name, value, **more):
    told = {"name": name, "type": "double", "min": 0.0, "max": 10.0, "default": value}
    return {**told, "description": f"the {name}", "unit": "", "choices": [], **more}


class Tuned:
    """Plays nodes with live parameters, by their names."""

    def __init__(self, play, **parameters):
        self.parameters = {f"/{name}": entries for name, entries in parameters.items()}
        self.values = {
            name: {entry["name"]: entry["default"] for entry in entries}
            for name, entries in self.parameters.items()
        }
        self.save = lambda _node: {"message": "saved"}
        self.played = play(
            [node(name, parameters=True) for name in self.parameters],
            parameters=lambda _session, fields: self.told(fields["node"]),
            set_parameters=self._set,
            save_parameters=lambda _session, fields: self.save(fields["node"]),
            close_parameters=lambda *_: {},
        )

    def told(self, name):
        groups = [{"name": "Default", "parameters": self.parameters[name], "groups": []}]
        return {"node": name, "groups": groups, "values": self.values[name], "save": True}

    def _set(self, _session, fields):
        self.values[fields["node"]].update(fields["values"])
        return {"values": self.values[fields["node"]], "refused": {}}


def number(name):
    return f"document.querySelector('.number-field[data-name={name}]')?.value"


def test_parameters_that_are_not_finite_leave_the_others_in_reach(page, play):
    inf = float("inf")
    limitless = parameter("limit", inf, min=None, max=None)
    tuned = Tuned(play, eye=[limitless, parameter("gain", inf), parameter("size", 2.0)])
    open_tool(page, "parameters")
    page.wait(f"{number('size')} === '2'")
    assert page.value(f"[{number('limit')}, {number('gain')}]") == ["", ""]
    page.fill(".number-field[data-name=gain]", "3")
    page.fill(".number-field[data-name=size]", "4")
    support.wait_for(lambda: tuned.values["/eye"] == {"limit": inf, "gain": 3, "size": 4}, "both")
    page.wait(f"{number('gain')} === '3'")


def test_parameters_that_a_node_has_newly_are_shown(page, play):
    tuned = Tuned(play, eye=[parameter("size", 2.0)])
    open_tool(page, "parameters")
    page.wait(f"{number('size')} === '2'")
    tuned.parameters["/eye"] = [parameter("size", 3.0), parameter("gain", 1.0)]
    tuned.values["/eye"] = {"size": 3.0, "gain": 1.0}
    tuned.played.sessions[0].push("parameters", tuned.told("/eye"), "/eye")
    page.wait(f"{number('gain')} === '1' && {number('size')} === '3'")


def test_what_is_saved_is_told_of_the_node_that_has_saved(page, play):
    tuned = Tuned(play, ear=[parameter("pitch", 1.0)], eye=[parameter("size", 2.0)])
    go_on = threading.Event()

    def save(name):
        assert go_on.wait(support.DEADLINE)
        return {"message": f"in the file of {name}"}

    tuned.save = save
    open_tool(page, "parameters")
    page.wait(f"{number('pitch')} === '1'")
    page.click('[data-test="save-parameters"]')
    page.wait_for_text("Saving", '[data-test="save-answer"]')
    page.fill('[data-test="parameter-node"]', "/eye")
    page.wait(f"{number('size')} === '2'")
    go_on.set()
    page.wait_for_notice("/ear: in the file of /ear")
    assert page.value("document.querySelector('[data-test=save-answer]').textContent") == ""
    page.click('[data-test="save-parameters"]')
    page.wait_for_text("in the file of /eye", '[data-test="save-answer"]')


def test_an_image_that_is_still_chosen_keeps_its_camera_info(page, play):
    folder = ["/eye/image_raw", "/eye/image_color", "/eye/camera_info"]
    listed = {"folder": "/bags", "free": 1e9, "max_megabytes": 100, "bags": [], "unfinished": []}
    recorded = []
    play(
        [],
        topics=folder,
        bags=lambda *_: {**listed, "recording": None},
        bag_record=lambda _session, fields: recorded.append((fields["images"], fields["topics"])),
    )
    open_tool(page, "bags")

    def choose(name, on):
        page.fill(f'[data-test="bag-topic"][data-name="images:{name}"]', on)

    def count(text):
        page.wait_for_text(text, '[data-test="bag-record"]')

    for name in folder[:2]:
        choose(name, True)
    count("Record 3 topics")
    choose("/eye/image_color", False)
    count("Record 2 topics")
    page.click('[data-test="bag-record"]')
    support.wait_for(
        lambda: recorded == [(["/eye/image_raw"], ["/eye/camera_info"])], "the request"
    )
    choose("/eye/image_raw", False)
    count("Choose what to record")


def test_each_camera_of_a_node_has_one_tile_however_many_there_are(page, play):
    images = ["/left/image_raw", "/right/image_raw"]
    views = [
        {"node": "/rig", "title": image, "image": image, "overlays": [], "processed": ""}
        for image in images
    ]
    played = play([node("/rig", publishes=images)], views[:1], images)
    drawn = "robotVision.tiles.list().filter((one) => one.view.drawn)"
    shown = f"{drawn}.map((one) => one.image).sort()"
    for count, here in ((1, images[:1]), (2, images), (1, images), (2, images)):
        played.graph["views"] = views[:count]  # the last image of what has gone stays
        played.sessions[-1].push("graph", played.graph)
        page.wait(f"robotVision.graph.views.length === {count}")
        page.wait(f"JSON.stringify({shown}) === JSON.stringify(arguments[0])", here)
        assert page.value("robotVision.tiles.list().length") == len(here)


def test_what_is_pushed_before_the_parameters_are_told_is_newer(page, play):
    tuned = Tuned(play, eye=[parameter("size", 2.0)])

    def tell(session, fields):
        told = tuned.told(fields["node"])
        session.push("values", {"node": "/eye", "values": {"size": 5.0}}, "/eye")
        return told

    tuned.played.answers["parameters"] = tell
    open_tool(page, "parameters")
    page.wait(f"{number('size')} && robotVision.connection.pending.size === 0")
    assert page.value(number("size")) == "5"


def test_what_is_pushed_before_the_colours_are_told_is_newer(page, play):
    tracker = Tracker(play)

    def tell(session, _fields):
        newer = {**tracker.values, "s_low": 60}
        session.push("values", {"node": NODE, "values": newer}, NODE)
        return {"values": tracker.values}

    tracker.played.answers["parameters"] = tell
    open_tool(page, "color")
    page.wait(f"{LIMIT} === '60'")
    page.wait("robotVision.connection.pending.size === 0")
    assert page.value(LIMIT) == "60"


def line(text, level=4):
    told = {"stamp": 5.0, "level": level, "node": "/eye", "text": text, "function": "f"}
    return {**told, "file": "f.py", "line": 1}


def test_the_log_says_where_lines_are_missing(page, play):
    played = play([], log=lambda *_: {}, close_log=lambda *_: {})
    open_tool(page, "log")
    support.wait_for(lambda: played.count("log"), "the request")

    def push(lines, left_out, key):
        played.sessions[0].push("log", {"entries": lines, "left_out": left_out}, key)

    push([line("first")], 0, "1")
    push([line("second")], 1, "2")
    push([line("third")], 70, "3")
    page.wait_for_text("third", '[data-test="log"]')
    shown = "[...document.querySelector('[data-test=log]').children].map((one) => one.innerText)"
    texts = page.value(shown)
    assert [one.splitlines()[-1] for one in texts] == [
        "first",
        "1 line is left out here: more came than is shown",
        "second",
        "70 lines are left out here: more came than is shown",
        "third",
    ]
    page.run("document.querySelector('#panel [aria-pressed]').click();")  # pauses
    for number in range(12):
        push([line(f"{number} {index}") for index in range(100)], 0, f"paused {number}")
    page.wait_for_text("Go on (1000)", "#panel button")
    page.run("document.querySelector('#panel [aria-pressed]').click();")
    page.wait_for_text("201 lines are left out", '[data-test="log-gap"]')
    page.wait_for_text("11 99", '[data-test="log"]')
