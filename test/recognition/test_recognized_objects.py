"""Refining, verifying and recognizing objects from Python, on NumPy arrays."""

import types

import numpy as np
import pytest
from std_msgs.msg import Header
from still_clock import StillClock

import robot_vision as rv
from robot_vision.recognition import recognition_markers
from robot_vision.recognition.found import Found, KnownObject
from robot_vision.recognition.known_objects import corners_of
from robot_vision.recognition.looks import Looks
from robot_vision.recognition.recognition_markers import ObjectMarkers, title
from robot_vision.recognition.recognition_messages import clouds_of
from robot_vision.recognition.recognizer import RecognitionParams, Recognizer
from robot_vision.recognition.straight_images import StraightImages

SIZE = (320, 240)
K = np.array([[525.0, 0.0, 159.5], [0.0, 525.0, 119.5], [0.0, 0.0, 1.0]])


def camera_of(distortion=()):
    return rv.CameraModel(*SIZE, K, list(distortion))


def pose_of(turn, place, center=(0.0, 0.0, 0.0)):
    """A pose by a rotation vector, and the place of a point of the object."""
    angle = np.linalg.norm(turn)
    x, y, z = np.asarray(turn) / max(angle, 1e-12)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    pose = np.eye(4)
    pose[:3, :3] += np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
    pose[:3, 3] = np.asarray(place) - pose[:3, :3] @ np.asarray(center)
    return pose


@pytest.fixture(scope="module")
def bracket():
    return rv.sample_mesh("bracket")


@pytest.fixture(scope="module")
def scene(bracket):
    """The bracket before a wall: its pose, the image and the depths of a Kinect."""
    truth = pose_of((2.0, 0.4, 0.2), (0.01, -0.01, 0.7), rv.mesh_extent(bracket.mesh).center)
    size = 2.0
    corners = [(x * size, y * size, 0.9) for y in (-1, 1) for x in (-1, 1)]
    wall = rv.Mesh(corners, [(0, 1, 2), (1, 3, 2)], color=(120, 150, 160))
    renderers = [rv.MeshRenderer(wall), rv.MeshRenderer(bracket.mesh)]
    view = rv.render_meshes(renderers, [np.eye(4), truth], K, (0, 0, *SIZE), bgr=True)
    depth = rv.DepthNoise("kinect", camera_of()).apply(0, view.depth)
    return truth, view.bgr, depth


@pytest.fixture(scope="module")
def shape(bracket):
    return rv.ObjectShape(bracket.mesh, bracket.symmetries)


@pytest.fixture(scope="module")
def frame(scene):
    made = rv.RecognitionFrame(camera_of())
    made.set(*scene[1:])
    return made


def test_a_pose_is_refined(scene, shape, frame):
    truth = scene[0]
    first = truth.copy()
    first[:3, 3] += (0.004, -0.003, 0.006)
    refined = rv.PoseRefiner().refine(frame, shape, first)
    assert np.linalg.norm(refined.pose[:3, 3] - truth[:3, 3]) < 0.002
    assert refined.covariance.shape == (6, 6)
    assert np.allclose(refined.covariance, refined.covariance.T)
    assert (np.linalg.eigvalsh(refined.covariance) > 0.0).all()
    assert refined.score > refined.first_score
    assert refined.free_axes == []


def test_an_axis_that_is_known_is_free(bracket, frame, scene):
    free = rv.ObjectShape(bracket.mesh, [((0.0, 0.0, 2.0), 0)])
    ((point, direction),) = rv.PoseRefiner().refine(frame, free, scene[0]).free_axes
    assert direction == (0.0, 0.0, 1.0) or direction == [0.0, 0.0, 1.0]
    assert np.allclose(point, rv.mesh_extent(bracket.mesh).center)


def test_a_pose_is_verified(scene, shape, frame):
    truth = scene[0]
    verifier = rv.PoseVerifier()
    right = verifier.verify(frame, shape, truth)
    assert right.probability > 0.9
    assert right.occlusion < 0.05
    assert right.evidence.agreeing > 0.8
    assert len(right.evidence.features) > 5
    _, _, width, height = right.box
    assert right.explained.shape == (-(-height // right.step), -(-width // right.step))
    assert set(np.unique(right.explained)) == {0, 255}
    wrong = truth.copy()
    wrong[0, 3] += 0.03
    assert verifier.verify(frame, shape, wrong).probability < 0.5
    frame_of_colors = rv.RecognitionFrame(camera_of())
    frame_of_colors.set(bgr=scene[1])
    assert np.isnan(verifier.verify(frame_of_colors, shape, truth).evidence.agreeing)


def test_an_object_is_recognized_and_another_one_is_not(scene, shape, frame):
    recognizer = rv.ObjectRecognizer()
    assert recognizer.add(shape) == 0
    assert recognizer.add(rv.ObjectShape(rv.sample_mesh("mug").mesh)) == 1
    candidates = [rv.PoseCandidate(model, scene[0], 0.8) for model in (0, 1)]
    assert (candidates[1].model, candidates[1].score, candidates[1].view) == (1, 0.8, 0)
    found = recognizer.recognize(frame, candidates)
    (one,) = found.objects
    assert one.model == 0
    assert one.probability > 0.9
    assert np.linalg.norm(one.pose[:3, 3] - scene[0][:3, 3]) < 0.002
    assert [report.found for report in found.reports] == [1, 0]
    middle = scene[0] @ np.append(shape.extent.center, 1.0)
    assert np.abs(middle[:3] - scene[0][:3, 3]).max() > 0.01
    assert found.reports[0].nearest_distance == pytest.approx(np.linalg.norm(middle[:3]))
    assert found.reports[0].reason == "found"
    assert found.reports[1].reason not in ("", "found")
    nothing = recognizer.recognize(frame, [])
    assert nothing.objects == []
    assert {report.reason for report in nothing.reports} == {"nothing looks like it"}


def test_point_pairs_find_it_and_come_back_from_bytes(bracket, scene, shape, frame):
    model = rv.train_point_pairs(bracket.mesh)
    data = model.to_bytes()
    assert isinstance(data, bytes)
    assert model.points.shape == model.normals.shape
    assert model.extent.diameter == shape.extent.diameter
    matcher = rv.PointPairMatcher()
    assert matcher.add(rv.PointPairModel.from_bytes(data)) == 0
    candidates = matcher.match(frame)
    center = np.append(shape.extent.center, 1.0)
    away = [np.linalg.norm((one.pose - scene[0]) @ center) for one in candidates]
    assert min(away) < 0.02
    assert candidates[0].model == 0
    with pytest.raises(ValueError, match="it ends too early"):
        rv.PointPairModel.from_bytes(data[:40])
    with pytest.raises(ValueError, match="the method of a trained model"):
        rv.PointPairModel.from_bytes(data.replace(b"PPF", b"XYZ"))


@pytest.mark.parametrize("model", ["equidistant", "fisheye"])
def test_a_fisheye_without_coefficients_bends_images_and_depths(model):
    """A ray at the angle t from the axis is f * t pixels from the center, not f * tan(t)."""
    focal, middle = 120.0, SIZE[0] / 2.0 - 0.5
    matrix = np.array([[focal, 0.0, middle], [0.0, focal, 119.5], [0.0, 0.0, 1.0]])
    fisheye = rv.CameraModel(*SIZE, matrix, [0.0] * 4, model)
    columns = np.tile(np.arange(SIZE[0]), (SIZE[1], 1))
    image = np.dstack([columns // 2] * 3).astype(np.uint8)
    depth = (1000 + columns).astype(np.uint16)
    for cameras in ((fisheye, None), (rv.CameraModel(*SIZE, matrix), fisheye)):
        bgr, depths = StraightImages(*cameras).apply(image, depth)
        for x in (20, 100, 200, 300):
            expected = middle + focal * np.arctan((x - middle) / focal)
            shown = expected if cameras[0] is fisheye else x
            assert abs(float(bgr[120, x, 0]) - shown / 2.0) < 1.5
            near = depths[115:126, x - 2 : x + 3]
            assert abs(np.median(near[near > 0]) - 1000 - expected) < 4.0


def test_markers_have_the_mesh_that_an_object_has_now():
    meshes = [rv.sample_mesh(name).mesh for name in ("mug", "nut")]
    markers, made = ObjectMarkers(), []
    for mesh in (meshes[0], meshes[0], meshes[1]):
        known = KnownObject("id", "thing", mesh, None, np.zeros((8, 3)), {})
        found = [Found(known, np.eye(4), np.eye(6), 1.0)]
        shape, text = markers.of(Header(frame_id="eye"), found).markers
        assert shape.header.frame_id == text.header.frame_id == "eye"
        made.append(shape.points)
    assert made[0] is made[1]  # It is made once.
    for points, mesh in zip(made[1:], meshes):
        corners = np.array([[point.x, point.y, point.z] for point in points])
        assert np.allclose(np.ptp(corners, axis=0), rv.mesh_extent(mesh).size, atol=0.01)


def test_markers_stay_until_the_next_image(monkeypatch):
    clock = StillClock()
    monkeypatch.setattr(recognition_markers, "time", clock)
    known = KnownObject("id", "thing", rv.sample_mesh("nut").mesh, None, np.ones((8, 3)), {})
    markers, lives = ObjectMarkers(), []
    for seconds, idle in ((0.0, 0), (0.03, 0), (1.5, 0), (600.0, 0), (0.03, 0), (600.0, 1)):
        clock.now += seconds
        if idle:
            markers.end()
        markers.note_image()
        clock.now += 0.1  # while it is worked on
        found = [Found(known, np.eye(4), np.eye(6), 1.0)]
        lives.append({one.lifetime.to_sec() for one in markers.of(Header(), found).markers})
    assert lives == [{0.5}, {0.5}, {3.2}, {20.0}, {0.5}, {0.5}]


def test_markers_are_of_the_rate_of_images_though_nobody_has_looked(monkeypatch):
    clock = StillClock()
    monkeypatch.setattr(recognition_markers, "time", clock)
    known = KnownObject("id", "thing", rv.sample_mesh("nut").mesh, None, np.ones((8, 3)), {})
    markers = ObjectMarkers()
    for _ in range(300):
        clock.now += 0.2
        markers.note_image()
    made = markers.of(Header(), [Found(known, np.eye(4), np.eye(6), 1.0)]).markers
    assert {one.lifetime.to_sec() for one in made} == {0.5}


def test_markers_of_objects_that_are_gone_are_not_kept(monkeypatch):
    monkeypatch.setattr(recognition_markers, "MAX_SHAPES", 3)
    mesh, markers = rv.sample_mesh("nut").mesh, ObjectMarkers()
    for number in range(10):
        known = KnownObject(str(number), "thing", mesh, None, np.zeros((8, 3)), {})
        assert markers.of(Header(), [Found(known, np.eye(4), np.eye(6), 1.0)]).markers
    assert len(markers._shapes) <= 3


def test_the_distance_of_an_object_is_that_of_its_middle():
    """Not of the origin of its mesh, which may be anywhere."""
    corners = np.full((8, 3), (0.0, 0.0, 0.5))
    known = KnownObject("id", "thing", None, None, corners, {})
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    pose[2, 3] = 1.5
    assert title(Found(known, pose, np.eye(6), 0.9)) == "thing 0.90: 1.00 m"


def test_the_range_of_distances_is_that_of_the_middle(shape):
    corners = np.full((8, 3), (0.0, 0.0, 0.8))
    known = KnownObject("id", "part", None, shape, corners, {})
    params = RecognitionParams.defaults()
    assert (params.match.min_distance, params.match.max_distance) == (0.3, 3.0)
    recognizer, pose = Recognizer([known], params), np.eye(4)
    for distance, is_in_range in ((-0.6, False), (0.1, True), (2.1, True), (2.4, False)):
        pose[2, 3] = distance
        assert recognizer._is_in_range(0, pose) is is_in_range


class Textures:
    """A matcher by textures that has found these, (x, y, width, height) and a probability each."""

    def __init__(self, *found):
        self._found = found

    def match(self, *_):
        pose = pose_of((0.0, 0.0, 0.0), (0.0, 0.0, 0.5))
        return [
            types.SimpleNamespace(model=0, pose=pose, covariance=np.eye(6), box=box, probability=p)
            for box, p in self._found
        ]


@pytest.mark.parametrize(
    "found, kept",
    [
        ([((50, 60, 40, 30), 0.52), ((51, 58, 40, 31), 0.48)], [0.52]),  # two tilts
        ([((50, 60, 40, 30), 0.5), ((52, 61, 40, 30), 0.9), ((48, 60, 40, 30), 0.6)], [0.9]),
        ([((50, 60, 40, 30), 0.9), ((90, 60, 40, 30), 0.8)], [0.9, 0.8]),  # side by side
        ([((50, 60, 40, 30), 0.9), ((65, 70, 40, 30), 0.8)], [0.9, 0.8]),  # half hidden
        ([((-5, -5, 0, 0), 0.9), ((-5, -5, 0, 0), 0.3)], [0.9]),
    ],
)
def test_what_has_no_mesh_is_found_once(shape, found, kept):
    known = KnownObject("id", "tea", None, shape, np.zeros((8, 3)), {}, is_box=True)
    params = RecognitionParams.defaults()
    params.decision.threshold = 0.4
    recognizer = Recognizer([known], params)
    recognizer._of_textures, recognizer._textures = [0], Textures(*found)
    there, told = recognizer.recognize(np.zeros((240, 320, 3), np.uint8), None, camera_of())
    assert [one.probability for one in there] == kept
    assert told == {"tea": f"found {len(kept)}, probability {kept[0]:.2f}"}


def test_what_only_depths_would_find_says_so(bracket, shape):
    """While others are looked for in the images alone."""
    pairs = {"PPF": rv.train_point_pairs(bracket.mesh).to_bytes()}
    objects = [
        KnownObject("1", "part", bracket.mesh, shape, np.zeros((8, 3)), pairs),
        KnownObject("2", "tea", None, shape, np.zeros((8, 3)), {}, is_box=True),
    ]
    recognizer = Recognizer(objects, RecognitionParams.defaults())
    recognizer._of_textures, recognizer._textures = [1], Textures()
    _, told = recognizer.recognize(np.zeros((240, 320, 3), np.uint8), None, camera_of())
    assert told["part"] == "not recognized: what was learned of it needs depth"


def test_depths_of_millimetres_and_arrays_with_gaps_will_do(scene, shape):
    truth, bgr, depth = scene
    wide = np.zeros((SIZE[1], 2 * SIZE[0]), np.uint16)
    wide[:, ::2] = np.nan_to_num(depth * 1000.0).round().astype(np.uint16)
    frame = rv.RecognitionFrame(camera_of())
    frame.set(bgr[:, :, :], wide[:, ::2])
    refined = rv.PoseRefiner().refine(frame, shape, truth)
    assert np.linalg.norm(refined.pose[:3, 3] - truth[:3, 3]) < 0.002


@pytest.mark.parametrize("distance", [0.7, 3.0])
def test_the_cloud_has_nearly_all_depths_of_an_object(bracket, shape, distance):
    """Also from afar, where the sensor's depths are centimetres off."""
    center = rv.mesh_extent(bracket.mesh).center
    truth = pose_of((2.0, 0.4, 0.2), (0.01, -0.01, distance), center)
    depth = rv.MeshRenderer(bracket.mesh).render(K, truth, (0, 0, *SIZE)).depth
    noisy = rv.DepthNoise("kinect", camera_of()).apply(0, depth)
    seen = np.isfinite(depth) & np.isfinite(noisy)
    depths = np.where(np.isfinite(depth), noisy, depth.dtype.type(distance + 0.2))
    known = KnownObject("id", "part", bracket.mesh, shape, corners_of(bracket.mesh), {})
    found = [Found(known, truth, np.eye(6), 1.0)]
    errors = rv.DepthErrorParams()
    (cloud,) = clouds_of(found, depths, camera_of(), Looks(), errors)
    assert 0.9 * seen.sum() < len(cloud) <= seen.sum()
    errors.depth_noise = 0.1
    (all_,) = clouds_of(found, depths, camera_of(), Looks(), errors)
    assert len(all_) >= len(cloud)


def test_what_cannot_be_is_refused(scene, shape, frame):
    truth, bgr, _ = scene
    with pytest.raises(ValueError, match="its images must be rectified"):
        rv.RecognitionFrame(camera_of(distortion=(0.1, 0.0, 0.0, 0.0)))
    empty = rv.RecognitionFrame(camera_of())
    with pytest.raises(ValueError, match="must be an image of colors, of depths, or both"):
        empty.set()
    with pytest.raises(ValueError, match="must be 320x240 as of its camera"):
        empty.set(bgr[1:])
    with pytest.raises(ValueError, match="the frame is empty"):
        rv.PoseRefiner().refine(empty, shape, truth)
    with pytest.raises(ValueError, match="4x4 pose"):
        rv.PoseRefiner().refine(frame, shape, truth[:3])
    with pytest.raises(ValueError, match="that of a rigid body"):
        rv.PoseVerifier().verify(frame, shape, 2.0 * truth)
    with pytest.raises(ValueError, match="the model of a candidate is 7"):
        rv.ObjectRecognizer().recognize(frame, [rv.PoseCandidate(7, truth)])
    params = rv.RecognizerParams()
    params.threshold = 2.0
    with pytest.raises(ValueError, match="threshold is 2, must be from 0 to 1"):
        rv.ObjectRecognizer(params)
    with pytest.raises(ValueError, match="the axis of a symmetry"):
        rv.ObjectShape(rv.sample_mesh("nut").mesh, [((0.0, 0.0, 0.0), 2)])
