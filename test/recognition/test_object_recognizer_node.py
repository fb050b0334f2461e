"""The node object_recognizer: all that it publishes, what it cannot use, and clients of others."""

import contextlib
import copy
import json
import re
import shutil
import sqlite3

import actionlib
import cv2
import numpy as np
import pytest
import rospy
import support
from calibrated_camera import info_of
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from foreign_messages import foreign_messages
from frames import Source, message, new_topic, pixels
from geometry_msgs.msg import TransformStamped
from sensor_msgs.msg import CameraInfo, Image, PointCloud2
from std_msgs.msg import Header
from std_srvs.srv import Trigger
from tag_studio import angle_between, matrix_of
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray

import robot_vision as rv
from robot_vision.meshes import sample_mesh
from robot_vision.msg import (
    DetectionArray,
    ObjectRecognitionAction,
    ObjectRecognitionGoal,
    ObjectType,
    RecognizedObjectArray,
    TableArray,
)
from robot_vision.recognition.database import Database, Mesh, Model, Object, Symmetry
from robot_vision.recognition.mesh_data import pack_mesh
from robot_vision.recognition.object_numbers import KEPT
from robot_vision.recognition.pair_method import PAIRS
from robot_vision.recognition.training_run import task_of, train
from robot_vision.recognition.view_method import VIEWS
from robot_vision.srv import GetObjectInformation

NAMES = ("duck", "can", "box")
DONE = (actionlib.GoalStatus.SUCCEEDED, actionlib.GoalStatus.ABORTED)
SYMMETRIES = {  # the box but for its textures, which the depths do not show
    "duck": [],
    "can": [Symmetry((0.0, 0.0, 1.0))],
    "box": [Symmetry((0.0, 0.0, 1.0), 2), Symmetry((1.0, 0.0, 0.0), 2)],
}
PLACE, TURN = 0.006, 5.0  # m and degrees, by which poses may be off
OUTPUTS = {
    "recognized_object_array": RecognizedObjectArray,
    "detections": DetectionArray,
    "tables": TableArray,
    "markers": MarkerArray,
    "processed_image": Image,
}


def add(path, name):
    with Database(str(path), write=True) as database, database.transaction():
        one = database.objects.add(Object(name))
        packed = pack_mesh(sample_mesh(name).mesh)
        mesh = Mesh(f"{name}.ply", b"", packed, symmetries=SYMMETRIES[name])
        database.meshes.set(one.id, mesh)
    return one


def learn(path, name, method=PAIRS, **parameters):
    with Database(str(path), write=True) as database:
        task = task_of(database, database.objects.find(name), method, parameters)
        train(database, task, False)


@pytest.fixture(scope="module")
def kitchen(tmp_path_factory):
    """A database of three objects, which are learned."""
    path = tmp_path_factory.mktemp("kitchen") / "objects.db"
    for name in NAMES:
        add(path, name)
        learn(path, name)
    learn(path, "duck", VIEWS, subdivisions=1)
    return path


class Table:
    """The scene of a table with the objects on it, as a camera with its lens sees them."""

    def __init__(self):
        meshes = [(name, sample_mesh(name).mesh) for name in NAMES]
        params = rv.SceneParams()
        params.width, params.height = 320, 240
        self.scene = rv.TabletopScene(params, meshes)
        self.camera = self.scene.view_camera("color")
        self.image = self.scene.render(0)
        own = self.scene.view_camera("depth")
        registration = rv.DepthRegistration(own, self.camera, self.scene.view_pose("depth"))
        self.depth = registration.apply(self.scene.render_depth(0))
        truth = self.scene.truth(0).objects
        self.poses = {one.name: np.asarray(one.pose) for one in truth if one.name in NAMES}


@pytest.fixture(scope="module")
def table():
    return Table()


class Eyes:
    """A camera whose images have depths, and what a node says of them."""

    def __init__(self, start, table, database, *words, program="object_recognizer.py", depth=True):
        self.table = table
        topic = new_topic()
        self.topic, beside = topic, topic.rsplit("/", 1)[0]
        self.images, self._depths = Source(topic), Source(f"{beside}/depth")
        self._infos = Source(f"{beside}/camera_info", CameraInfo)
        self.info = info_of(table.camera)
        self.number = 0
        inputs = [f"image:={topic}"] + [f"depth:={beside}/depth"] * depth
        self.has_depth = depth
        if program == "object_recognizer.py":
            inputs += [f"_database:={database}", "_methods:=PPF"]
        self.process = start(program, *inputs, "_diagnostic_period:=0.05", *words)

    def wait_for(self):
        for source in (self.images, self._infos) + (self._depths,) * self.has_depth:
            source.wait_for()

    def show(self, image=None, depth=None):
        self.number += 1
        header = Header(stamp=rospy.Time(self.number), frame_id="eye")
        if self.info is not None:
            self._infos.send(self.info)
        if self.has_depth:
            depths = message(self.table.depth if depth is None else depth, "32FC1")
            depths.header = header
            self._depths.send(depths)
        made = message(self.table.image if image is None else image, "bgr8")
        made.header = header
        self.images.send(made)
        return header

    def shown_until(self, condition, what, depth=None):
        """Shows images until something is true."""

        def shown():
            self.show(depth=depth)
            return condition()

        return support.wait_for(shown, what)

    def answer(self, outputs):
        """What is said of an image on each of these topics."""
        topics = {
            name: support.subscribed(f"/object_recognizer/{name}", OUTPUTS[name])
            for name in outputs
        }
        self.wait_for()

        def stamps(messages):
            received = messages.received
            if messages is topics.get("markers"):
                return {one.markers[0].header.stamp: one for one in received if one.markers}
            return {support.stamp_of(one): one for one in received}

        def common():
            return set.intersection(*(set(stamps(one)) for one in topics.values()))

        stamp = max(self.shown_until(common, "answers"))
        return {name: stamps(one)[stamp] for name, one in topics.items()}


def named(kitchen, array):
    """The objects of an array by their names."""
    with Database(str(kitchen)) as database:
        return {database.objects.find(one.type.key).name: one for one in array.objects}


def require_pose(name, pose, truth):
    """Compares a pose with the truth, but for turns that nobody can see."""
    middle = [*rv.mesh_extent(sample_mesh(name).mesh).center, 1.0]
    assert np.linalg.norm((pose - truth) @ middle) < PLACE, name
    if name == "can":
        along = np.clip(pose[:3, 2] @ truth[:3, 2], -1.0, 1.0)
        assert np.degrees(np.arccos(along)) < TURN
        return
    turns = [(1, 1), (-1, -1), (1, -1), (-1, 1)] if name == "box" else [(1, 1)]
    turned = [pose @ np.diag([x, y, x * y, 1.0]) for x, y in turns]
    assert min(angle_between(one, truth) for one in turned) < TURN, name


def test_all_topics_of_an_image(start, kitchen, table):
    eyes = Eyes(start, table, kitchen)
    transforms = support.subscribed("/tf", TFMessage)
    found = eyes.answer(OUTPUTS)
    array = found["recognized_object_array"]
    stamp = array.header.stamp
    objects = named(kitchen, array)
    assert set(objects) == set(NAMES) and len(array.objects) == len(NAMES)
    for name, one in objects.items():
        truth = table.poses[name]
        require_pose(name, matrix_of(one.pose.pose.pose), truth)
        assert one.pose.header == one.header == array.header and one.header.frame_id == "eye"
        covariance = np.reshape(one.pose.pose.covariance, (6, 6))
        assert np.linalg.eigvalsh(covariance)[0] > 0.0 and covariance[0, 0] < 0.01**2
        assert 0.6 < one.confidence <= 1.0
        assert json.loads(one.type.db) == {"type": "SQLite", "root": str(kitchen)}
        check_cloud(one, truth, name)
        extent = rv.mesh_extent(sample_mesh(name).mesh)
        corners = np.array([[point.x, point.y, point.z] for point in one.bounding_contours])
        assert np.allclose(corners.max(axis=0) - corners.min(axis=0), extent.size, atol=1e-6)
        assert len(one.bounding_mesh.triangles) == 12 and len(one.bounding_mesh.vertices) == 8
    check_detections(found["detections"], table)
    (desk,) = found["tables"].tables
    assert len(desk.convex_hull) >= 4 and found["tables"].header.stamp == stamp
    check_markers(found["markers"], table)
    assert not np.array_equal(pixels(found["processed_image"]), table.image)
    difference = cv2.absdiff(pixels(found["processed_image"]), table.image).max(axis=2)
    mask = np.zeros(difference.shape, np.uint8)
    for one in found["detections"].detections:
        outline = np.array([[(point.x, point.y) for point in one.outline]], np.int32)
        cv2.fillPoly(mask, outline, 255)
    assert (difference[cv2.erode(mask, np.ones((5, 5))) > 0] > 0).mean() > 0.5
    eyes.shown_until(lambda: transforms.received, "transforms")
    newest = transforms.received[-1]
    frames = {one.child_frame_id: one for one in newest.transforms}
    assert set(frames) == {f"{name}_0" for name in NAMES}
    for name in NAMES:
        assert frames[f"{name}_0"].header.frame_id == "eye"
        require_pose(name, matrix_of(frames[f"{name}_0"].transform), table.poses[name])


def check_cloud(one, truth, name):
    """The points of an object are on its surface."""
    (cloud,) = one.point_clouds
    assert isinstance(cloud, type(PointCloud2())) and cloud.header == one.header
    places = np.frombuffer(cloud.data, np.float32).reshape(cloud.width, -1)[:, :3].astype(float)
    assert len(places) > 300
    own = (places - truth[:3, 3]) @ truth[:3, :3]
    extent = rv.mesh_extent(sample_mesh(name).mesh)
    beyond = np.abs(own - extent.center) - np.asarray(extent.size) / 2.0
    assert beyond.max() < 0.02


def check_detections(array, table):
    assert (array.width, array.height) == table.image.shape[1::-1]
    assert {one.label for one in array.detections} == set(NAMES)
    for one in array.detections:
        known = next(known for known in table.scene.truth(0).objects if known.name == one.label)
        outline = np.asarray(known.outline)
        low, high = outline.min(axis=0), outline.max(axis=0)
        box = one.box
        assert np.abs(np.array([box.x_offset, box.y_offset]) - low).max() < 6
        assert np.abs([box.x_offset + box.width, box.y_offset + box.height] - high).max() < 6
        assert one.id == -1 and one.area > 300 and 0.6 < one.score <= 1.0


def check_markers(array, table):
    meshes = {one.id: one for one in array.markers if one.ns == "meshes"}
    texts = {one.id: one.text for one in array.markers if one.ns == "names"}
    assert set(meshes) == set(texts) and len(meshes) == len(NAMES)
    for number, marker in meshes.items():
        name = texts[number].split()[0]
        assert marker.type == Marker.TRIANGLE_LIST and marker.header.frame_id == "eye"
        assert len(marker.points) == len(marker.colors) * 3 or len(marker.points) == len(
            marker.colors
        )
        require_pose(name, matrix_of(marker.pose), table.poses[name])
        corners = np.array([[point.x, point.y, point.z] for point in marker.points])
        assert len(corners) <= 3 * 2000
        extent = rv.mesh_extent(sample_mesh(name).mesh)
        assert np.abs(corners.max(axis=0) - corners.min(axis=0) - extent.size).max() < 0.012


def before_a_wall(table, name, distance):
    """The camera of a table before one of its objects, which is so far away (m), and a gray wall.

    Returns it with the pose of the object.
    """
    pose, mesh = table.poses[name].copy(), sample_mesh(name).mesh
    pose[:3, 3] = (0.0, 0.0, distance) - pose[:3, :3] @ rv.mesh_extent(mesh).center
    region = 0, 0, table.camera.width, table.camera.height
    view = rv.MeshRenderer(mesh).render(table.camera, pose, region, bgr=True)
    seen = copy.copy(table)
    seen.image = np.where(np.isfinite(view.depth)[..., None], view.bgr, 110).astype(np.uint8)
    return seen, pose


def test_images_without_objects_let_numbers_be_forgotten(start, tmp_path, kitchen, table):
    path = tmp_path / "objects.db"
    shutil.copy(kitchen, path)
    names = {"duck": "a/thing", "box": "a_thing"}  # one label in the names of frames
    with contextlib.closing(sqlite3.connect(path)) as file, file:
        for old, new in names.items():
            file.execute("UPDATE objects SET name = ? WHERE name = ?", (new, old))
    eyes = Eyes(start, table, path, f"_objects:={','.join(names.values())}")
    arrays = support.subscribed("/object_recognizer/recognized_object_array", RecognizedObjectArray)
    transforms = support.subscribed("/tf", TFMessage)
    eyes.wait_for()
    eyes.shown_until(lambda: transforms.received, "transforms")
    places = {one.child_frame_id: one.transform for one in transforms.received[-1].transforms}
    assert set(places) == {"a_thing_0", "a_thing_1"}
    first = matrix_of(places["a_thing_0"])
    gone = min(names, key=lambda name: np.linalg.norm((first - table.poses[name])[:3, 3]))
    empty = np.full_like(table.depth, np.nan)
    without = lambda: [one for one in arrays.received if not one.objects]  # noqa: E731
    eyes.shown_until(lambda: len(without()) > KEPT, "images without objects", empty)
    (known,) = [one for one in table.scene.truth(0).objects if one.name == gone]
    mask = cv2.fillPoly(np.zeros(empty.shape, np.uint8), [np.int32(known.outline)], 1)
    alone = np.where(cv2.dilate(mask, np.ones((9, 9))), np.nan, table.depth).astype(np.float32)
    count = len(transforms.received)
    eyes.shown_until(lambda: len(transforms.received) > count, "transforms", alone)
    (left,) = transforms.received[-1].transforms
    assert left.child_frame_id == "a_thing_0"


def test_views_of_images_with_depth_and_alone(start, kitchen, table):
    words = "_objects:=duck", "_methods:=LINEMOD"
    eyes = Eyes(start, table, kitchen, *words)
    (one,) = eyes.answer(["recognized_object_array"])["recognized_object_array"].objects
    require_pose("duck", matrix_of(one.pose.pose.pose), table.poses["duck"])
    eyes.process.interrupt()
    assert eyes.process.exit_code() == 0
    calm, pose = before_a_wall(table, "duck", 0.6)
    eyes = Eyes(start, calm, kitchen, *words, depth=False)
    (one,) = eyes.answer(["recognized_object_array"])["recognized_object_array"].objects
    assert one.point_clouds == []
    require_pose("duck", matrix_of(one.pose.pose.pose), pose)


def test_live_parameters(start, kitchen, table):
    eyes = Eyes(start, table, kitchen)
    arrays = support.subscribed("/object_recognizer/recognized_object_array", RecognizedObjectArray)
    eyes.wait_for()

    def found(**values):
        support.reconfigured("/object_recognizer", **values)
        before = eyes.number
        newer = lambda: [one for one in arrays.received if one.header.stamp.secs > before]  # noqa: E731
        eyes.shown_until(newer, "an image")
        return set(named(kitchen, newer()[-1]))

    assert found(objects=" duck, can") == {"duck", "can"}
    place = dict(zip("xyz", table.poses["duck"][:3, 3].tolist()))
    low = {f"{axis}_min": value - 0.02 for axis, value in place.items()}
    high = {f"{axis}_max": value + 0.02 for axis, value in place.items()}
    assert found(crop=True, **low, **high) == {"duck"}
    newest = statuses()

    def left_out():
        """The reasons of a status, if they are those of the crop; frames may miss their depth."""
        reasons = values_of(newest()) if newest() else {}
        is_of_crop = reasons.get("can", "").endswith(", 1 outside of the crop")
        return reasons if is_of_crop else None

    assert eyes.shown_until(left_out, "what became of the can")["duck"].count(",") == 1
    assert found(crop=False, objects="box", max_distance=0.5) == set()
    assert found(objects="", max_distance=3.0) == set(NAMES)
    assert found(on_tables=True) == set(NAMES)
    config = support.reconfigured("/object_recognizer", crop=True, z_min=3.0, z_max=2.0)
    assert config["z_min"] == pytest.approx(low["z_min"])
    eyes.process.wait_for_output("z_min is 3, must be at most z_max, 2")


def values_of(status):
    return {one.key: one.value for one in status.values}


def statuses():
    arrays = support.subscribed("/diagnostics", DiagnosticArray)

    def newest():
        found = [one for array in list(arrays.received) for one in array.status]
        of_objects = [one for one in found if one.name == "object_recognizer: objects"]
        return of_objects[-1] if of_objects else None

    return newest


def test_what_cannot_be_recognized_is_told_until_it_can(start, tmp_path, table):
    path = tmp_path / "objects.db"
    eyes = Eyes(start, table, path)
    newest = statuses()
    arrays = support.subscribed("/object_recognizer/recognized_object_array", RecognizedObjectArray)
    shown = support.subscribed("/object_recognizer/processed_image", Image)
    eyes.wait_for()

    def told(level, text):
        eyes.shown_until(
            lambda: newest() and newest().level == level and text in newest().message,
            f"'{text}' on /diagnostics, which has {newest()}",
        )

    told(DiagnosticStatus.ERROR, f"there is no database {path}: object_add.py makes it")
    eyes.process.wait_for_output(f"there is no database {path}")
    eyes.shown_until(lambda: shown.received, "an overlay")
    assert not arrays.received
    add(path, "duck")
    told(DiagnosticStatus.ERROR, f"no object in {path} was learned by PPF: training does it")
    learn(path, "duck")
    told(DiagnosticStatus.OK, "1 recognized of 1 known objects")
    assert values_of(newest())["duck"].startswith("found 1, probability")
    add(path, "can")
    told(DiagnosticStatus.WARN, "'can' was not learned by PPF: training does it")
    with Database(str(path), write=True) as database, database.transaction():
        one = database.objects.find("can")
        database.models.set(Model(one.id, "PPF", {}, "key", b"no model"))
    told(DiagnosticStatus.WARN, "'can' is not recognized by PPF: the beginning of a trained model")

    def duck():
        return values_of(newest()).get("duck", "")

    eyes.shown_until(lambda: duck().startswith("found 1, probability"), "the duck")
    eyes.process.wait_for_output("'can' is not recognized by PPF: the beginning of a trained model")
    with Database(str(path), write=True) as database, database.transaction():
        database.objects.delete(database.objects.find("can").id)
    told(DiagnosticStatus.OK, "1 recognized of 1 known objects")
    blank = np.full_like(table.image, 128)

    def not_found():
        eyes.show(blank, np.full_like(table.depth, 2.0))
        return duck().startswith("not found: ")

    support.wait_for(not_found, "the reason why the duck is not found")


def test_tables_need_no_objects(start, tmp_path, table):
    """Neither a database, nor methods, as of an .ork file with TabletopTableDetector alone."""
    path = tmp_path / "objects.db"
    eyes = Eyes(start, table, path)
    (desk,) = eyes.answer(["tables"])["tables"].tables
    assert len(desk.convex_hull) >= 4
    eyes.process.wait_for_output(f"there is no database {path}")
    eyes.process.interrupt()
    assert eyes.process.exit_code() == 0
    eyes = Eyes(start, table, path, "_methods:=''")
    newest = statuses()
    assert len(eyes.answer(["tables"])["tables"].tables) == 1
    fine = DiagnosticStatus.OK, "0 recognized of 0 known objects"
    is_fine = lambda: newest() and (newest().level, newest().message) == fine  # noqa: E731
    eyes.shown_until(is_fine, "a status")
    assert "there is no database" not in eyes.process.output()


def test_images_without_depth_are_a_problem(start, kitchen, table):
    eyes = Eyes(start, table, kitchen)
    newest = statuses()
    client = actionlib.SimpleActionClient(
        "/object_recognizer/recognize_objects", ObjectRecognitionAction
    )
    assert client.wait_for_server(rospy.Duration(support.DEADLINE))
    arrays = support.subscribed("/object_recognizer/recognized_object_array", RecognizedObjectArray)
    eyes.wait_for()

    def told(level, text):
        eyes.shown_until(
            lambda: newest() and newest().level == level and text in newest().message,
            f"'{text}' on /diagnostics, which has {newest()}",
        )

    told(DiagnosticStatus.OK, "3 recognized of 3 known objects")
    eyes.info, known = CameraInfo(width=1, height=1, K=eyes.info.K), eyes.info
    told(DiagnosticStatus.ERROR, "no objects: camera_info on ")
    assert newest().values == []
    eyes.info = known
    told(DiagnosticStatus.OK, "3 recognized of 3 known objects")
    eyes.has_depth = False
    told(DiagnosticStatus.ERROR, ": nothing is recognized")
    assert newest().message.startswith(f"no depth on {eyes.topic.rsplit('/', 1)[0]}/depth ")
    client.send_goal(ObjectRecognitionGoal())
    eyes.shown_until(client.get_result, "the result of the action")
    support.wait_for(lambda: client.get_state() == actionlib.GoalStatus.ABORTED, "its state")
    status = client.get_goal_status_text()
    assert status.startswith("no depth on ") and status.endswith(": nothing is recognized")
    eyes.has_depth = True
    before = eyes.number
    newer = lambda: [one for one in arrays.received if one.header.stamp.secs > before]  # noqa: E731
    eyes.shown_until(newer, "an image with depth")
    told(DiagnosticStatus.OK, "3 recognized of 3 known objects")


def test_goals_of_an_idle_node_wait_until_it_is_known_what_is_up(start, kitchen, table):
    """What is asked for is on tables, which are those that are level."""
    eyes = Eyes(start, table, kitchen, "_on_tables:=true", "_vertical_frame:=level")
    client = actionlib.SimpleActionClient(
        "/object_recognizer/recognize_objects", ObjectRecognitionAction
    )
    assert client.wait_for_server(rospy.Duration(support.DEADLINE))
    newest = statuses()

    def answer():
        return outcome(client, ObjectRecognitionGoal(), eyes)

    lack = "no transform from the vertical_frame 'level' to its frame 'eye', expected on "
    state, text = answer()
    assert state == actionlib.GoalStatus.ABORTED and text.startswith(lack)
    support.wait_for(lambda: newest() and newest().message.startswith(lack), "that in the status")
    transforms = rospy.Publisher("/tf_static", TFMessage, queue_size=1, latch=True)
    # The camera looks along what is said to be up, and sees no table from there.
    upright = TransformStamped(child_frame_id="level")
    upright.header.frame_id = "eye"
    upright.transform.rotation.w = 1.0
    transforms.publish(TFMessage([upright]))
    assert answer()[0] == actionlib.GoalStatus.SUCCEEDED
    assert client.get_result().recognized_objects.objects == []
    missed = "not found: nothing stands on a table"
    support.wait_for(lambda: values_of(newest()) == dict.fromkeys(NAMES, missed), "the reasons")
    assert support.reconfigured("/object_recognizer", vertical_frame="")["vertical_frame"] == ""
    assert answer()[0] == actionlib.GoalStatus.SUCCEEDED
    assert set(named(kitchen, client.get_result().recognized_objects)) == set(NAMES)
    told = "3 recognized of 3 known objects"
    support.wait_for(lambda: newest().message == told, "the status of the last image")
    transforms.unregister()


def test_what_needs_depth_says_so_without_it(start, kitchen, table):
    eyes = Eyes(start, table, kitchen, depth=False)
    newest = statuses()
    shown = support.subscribed("/object_recognizer/processed_image", Image)
    eyes.wait_for()
    said = "what was learned of the objects needs depth, and the name 'depth' is not remapped"

    def is_told():
        status = newest()
        return (
            shown.received
            and status
            and (status.level, status.message) == (DiagnosticStatus.ERROR, said)
        )

    eyes.shown_until(is_told, "a status and an overlay")


def test_an_image_before_the_first_camera_info_is_no_error(start, kitchen, table):
    eyes = Eyes(start, table, kitchen)
    eyes.info, known = None, eyes.info
    arrays = support.subscribed("/object_recognizer/recognized_object_array", RecognizedObjectArray)
    eyes.wait_for()
    told = statuses()
    eyes.show()
    assert support.wait_for(told, "the status of this image").level == DiagnosticStatus.OK
    eyes.info = known
    eyes.shown_until(lambda: arrays.received, "what is recognized")


def test_reload(start, tmp_path, table):
    path = tmp_path / "objects.db"
    Eyes(start, table, path)
    rospy.wait_for_service("/object_recognizer/reload", support.DEADLINE)
    reload = rospy.ServiceProxy("/object_recognizer/reload", Trigger)
    answer = reload()
    assert not answer.success and answer.message.startswith(f"there is no database {path}")
    add(path, "duck")
    learn(path, "duck")
    answer = reload()
    assert answer.success and answer.message == "duck"


@pytest.mark.parametrize(
    "name, value, text",
    [
        ("database", "objects.db", "database is 'objects.db', must be an absolute path"),
        ("database", "/dev/null", "/dev/null cannot be read: it is no file"),
        ("methods", "SIFT", "must be names of methods between commas: LINEMOD, PPF, TOD"),
        ("threshold", 2.0, "threshold is 2, must be from 0 to 1"),
        ("vertical_frame", "a\nb", "vertical_frame is 'a\\nb', must be empty or a name"),
        ("min_distance", 5.0, "max_distance is 3, must be above min_distance, 5"),
    ],
)
def test_bad_value_at_start_is_fatal(start, name, value, text):
    support.assert_fatal_at_start(start, "object_recognizer.py", name, value, text)


def test_a_newer_database_is_fatal(start, tmp_path):
    path = tmp_path / "objects.db"
    add(path, "duck")
    import sqlite3

    with sqlite3.connect(str(path)) as file:
        file.execute("PRAGMA user_version = 99")
    file.close()
    said = "is a database of version 99, must be of 1 to 1"
    support.assert_fatal_at_start(start, "object_recognizer.py", "database", str(path), said)


def write_ork(tmp_path, kitchen, objects="all"):
    file = tmp_path / "detection.ros.ork"
    file.write_text(
        f"""
source1:
  type: RosKinect
  parameters: {{rgb_frame_id: eye}}
sink1: {{type: Publisher, inputs: [source1]}}
pipeline1:
  type: PpfDetector
  inputs: [source1]
  outputs: [sink1]
  parameters:
    object_ids: {json.dumps(objects)}
    threshold: 93.5
    db: {{type: SQLite, root: {kitchen}}}
"""
    )
    return file


def test_clients_of_ork(start, kitchen, table, tmp_path):
    """Theirs in C++ and in Python, built with their own messages, and their action client."""
    theirs = foreign_messages("object_recognition_msgs", tmp_path)
    file = write_ork(tmp_path, kitchen)
    eyes = Eyes(start, table, kitchen, "-c", file, program="detection")
    in_cpp = start("test_ork_client")
    arrays = support.Messages("/recognized_object_array", theirs.msg.RecognizedObjectArray)
    tables = support.Messages("/table_array", theirs.msg.TableArray)
    eyes.shown_until(lambda: arrays.received and tables.received, "their messages")
    objects = named(kitchen, arrays.received[-1])
    assert set(objects) == set(NAMES) and len(tables.received[-1].tables) == 1
    eyes.shown_until(
        lambda: re.search("^information", in_cpp.output(), re.MULTILINE), "their client in C++"
    )
    said = in_cpp.output()
    line = re.search(r"^information (\w+) (\d+) (\d+)$", said, re.MULTILINE)
    name, vertices, triangles = line.groups()
    mesh = sample_mesh(name).mesh
    assert (int(vertices), int(triangles)) == (len(mesh.vertices), len(mesh.triangles))
    key, _, *place = re.findall(r"^object (\w+) (\S+) (\S+) (\S+) (\S+)$", said, re.MULTILINE)[0]
    with Database(str(kitchen)) as database:
        truth = table.poses[database.objects.find(key).name]
    assert np.linalg.norm(np.array(place, float) - truth[:3, 3]) < PLACE
    call = rospy.ServiceProxy("/get_object_info", theirs.srv.GetObjectInformation)
    answer = call(theirs.msg.ObjectType("can", ""))
    assert answer.information.name == "can"
    with pytest.raises(rospy.ServiceException, match="there is no object 'spoon'"):
        call(theirs.msg.ObjectType("spoon", ""))
    client = actionlib.SimpleActionClient("/recognize_objects", theirs.msg.ObjectRecognitionAction)
    require_goal(client, theirs.msg.ObjectRecognitionGoal, eyes, kitchen)


def outcome(client, goal, eyes):
    """The state and the text of a goal for which camera_info and depth have come in time.

    A node that was idle gives them 2 s behind its first image, which may pass on a busy machine.
    """
    late = "there is none", "can be used with the images"

    def ended():
        client.send_goal(goal)
        # Its state may come before the result, or behind it.
        eyes.shown_until(client.get_result, "the result of the action")
        support.wait_for(lambda: client.get_state() in DONE, "its state")
        text = client.get_goal_status_text()
        return None if any(words in text for words in late) else (client.get_state(), text)

    return support.wait_for(ended, "a result of images with all that belongs to them")


def require_goal(client, goal, eyes, kitchen):
    """Sends goals: without limits, with limits around one object, and with wrong ones."""
    assert client.wait_for_server(rospy.Duration(support.DEADLINE))

    def result(**values):
        outcome(client, goal(**values), eyes)
        return client.get_result()

    found = result().recognized_objects
    assert set(named(kitchen, found)) == set(NAMES)
    low, high = (eyes.table.poses["box"][:3, 3] + shift for shift in (-0.02, 0.02))
    limits = np.column_stack([low, high]).ravel().tolist()
    found = result(use_roi=True, filter_limits=limits).recognized_objects
    assert set(named(kitchen, found)) == {"box"}
    result(use_roi=True, filter_limits=[0.0])
    assert client.get_state() == actionlib.GoalStatus.ABORTED
    assert "filter_limits has 1 numbers, must be least x" in client.get_goal_status_text()


def test_the_action_without_subscribers(start, kitchen, table):
    """The node works for it alone; a goal that is canceled is given up."""
    eyes = Eyes(start, table, kitchen)
    client = actionlib.SimpleActionClient(
        "/object_recognizer/recognize_objects", ObjectRecognitionAction
    )
    require_goal(client, ObjectRecognitionGoal, eyes, kitchen)
    eyes.images.wait_for(0)  # no frame is in work
    client.send_goal(ObjectRecognitionGoal())
    support.wait_for(lambda: client.get_state() == actionlib.GoalStatus.ACTIVE, "the goal")
    client.cancel_goal()
    support.wait_for(lambda: client.get_state() == actionlib.GoalStatus.PREEMPTED, "its end")


def test_the_action_tells_that_there_is_no_calibration(start, kitchen, table):
    eyes = Eyes(start, table, kitchen)
    eyes.info, known = None, eyes.info
    client = actionlib.SimpleActionClient(
        "/object_recognizer/recognize_objects", ObjectRecognitionAction
    )
    assert client.wait_for_server(rospy.Duration(support.DEADLINE))
    client.send_goal(ObjectRecognitionGoal())
    eyes.shown_until(client.get_result, "the result of the action")
    support.wait_for(lambda: client.get_state() == actionlib.GoalStatus.ABORTED, "its state")
    assert client.get_goal_status_text() == (
        f"no objects: camera_info on {eyes.topic.rsplit('/', 1)[0]}/camera_info: there is none"
    )
    eyes.info = known
    require_goal(client, ObjectRecognitionGoal, eyes, kitchen)


def test_detection_tells_what_it_cannot_use(start, tmp_path, kitchen):
    file = write_ork(tmp_path, tmp_path / "none.db")
    process = start("detection", "-c", file)
    assert process.exit_code() == 1
    assert f"warning: {file}: pipeline1: threshold is not used" in process.output()
    fatal = [line for line in process.output().splitlines() if "FATAL" in line]
    said = f"there is no database {tmp_path / 'none.db'}: object_add.py makes it"
    assert len(fatal) == 1 and said in fatal[0]
    add(tmp_path / "none.db", "duck")
    process = start("detection", "-c", file)
    assert process.exit_code() == 1 and "was learned by PPF: training does" in process.output()
    process = start("detection", "-c", write_ork(tmp_path, kitchen, ["spoon"]))
    assert process.exit_code() == 1
    assert process.output().splitlines()[-1] == (
        f"detection: there is no object 'spoon' in {kitchen}"
    )


def test_what_a_file_has_set_is_gone_with_the_next_one(start, tmp_path):
    """But not what was typed."""
    database = tmp_path / "objects.db"
    add(database, "duck")
    source = f"""
source1:
  type: RosKinect
  parameters: {{rgb_image_topic: /eye/image_rect, crop_enabled: true, x_max: 0.25}}
pipeline1: {{type: TabletopObjectDetector, object_names: [duck], db: {{root: {database}}}}}
"""
    first, second = tmp_path / "first.ork", tmp_path / "second.ork"
    first.write_text(source)
    second.write_text("pipeline1: {type: TabletopTableDetector}\n")
    process = start("detection", "-c", first, "_threshold:=0.25")
    assert process.exit_code() == 1, "there is no model"
    left = rospy.get_param("/object_recognition")
    assert left["crop"] and left["x_max"] == 0.25 and left["objects"] and left["on_tables"]
    assert left["rectified"] and left["needs_models"]
    start("detection", "-c", second, "image:=/eye/image_raw")
    rospy.wait_for_service("/object_recognition/save_parameters", support.DEADLINE)
    known = rospy.get_param("/object_recognition")
    assert known["threshold"] == 0.25
    assert (known["crop"], known["x_max"], known["objects"]) == (False, 1.0, "")
    assert (known["on_tables"], known["rectified"]) == (False, False)
    assert "needs_models" not in known and "database" not in known


def test_information(start, kitchen, table):
    Eyes(start, table, kitchen)
    service = "/object_recognizer/get_object_info"
    rospy.wait_for_service(service, support.DEADLINE)
    call = rospy.ServiceProxy(service, GetObjectInformation)
    mesh = sample_mesh("duck").mesh
    with Database(str(kitchen)) as database:
        key = database.objects.find("duck").id
    information = call(ObjectType(key, "")).information
    vertices = np.array([[one.x, one.y, one.z] for one in information.ground_truth_mesh.vertices])
    triangles = np.array([one.vertex_indices for one in information.ground_truth_mesh.triangles])
    assert information.name == "duck" and np.allclose(vertices, mesh.vertices)
    assert np.array_equal(triangles, mesh.triangles)
    cloud = np.frombuffer(information.ground_truth_point_cloud.data, np.uint8).reshape(-1, 16)
    assert np.array_equal(cloud[:, :12].copy().view(np.float32), mesh.vertices)
    assert np.array_equal(cloud[:, 12:15], mesh.colors)
