"""object_capture.py on a synthetic turntable: views, masks, poses, a mesh, and what is learned."""

import os
import pathlib

import cv2
import numpy as np
import pytest
import rosbag
import rospy
import turntable
from frames import message
from sensor_msgs.msg import CameraInfo
from textured_boxes import box, pose_error

from robot_vision import Bundle, BundleTag, CameraModel, TextureMatcher, TextureModel
from robot_vision.meshes import Mesh, mesh_extent, write_mesh
from robot_vision.recognition import capture_run, captured_mesh, mesh_add, object_capture, training
from robot_vision.recognition.capture_plate import plate_of, read_plate_bundle
from robot_vision.recognition.database import Database, Object
from robot_vision.recognition.database.observations import Observations
from robot_vision.recognition.known_objects import load_objects
from robot_vision.recognition.mesh_data import unpack_mesh
from robot_vision.recognition.observed_views import seen_by
from robot_vision.recognition.recognizer import RecognitionParams, Recognizer
from robot_vision.tags.bundle_files import write_bundles

VIEWS = 14
SIZE = np.array([0.10, 0.08, 0.12])  # m, of the object


def standing_box():
    made = box(SIZE, 3)
    return Mesh(
        made.vertices + np.float32([0.0, 0.0, SIZE[2] / 2.0]),
        made.triangles,
        texture_coordinates=made.texture_coordinates,
        textures=made.textures,
        triangle_textures=made.triangle_textures,
    )


@pytest.fixture(scope="module")
def table():
    return turntable.Turntable(standing_box())


@pytest.fixture(scope="module")
def frames(table):
    return table.turn(VIEWS)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, frames):
    return turntable.write_frames(tmp_path_factory.mktemp("turn") / "frames", frames)


@pytest.fixture(scope="module")
def plate(tmp_path_factory):
    return turntable.write_bundle(tmp_path_factory.mktemp("plate") / "plate.yaml")


@pytest.fixture
def path(tmp_path):
    path = str(tmp_path / "objects.db")
    with Database(path, write=True) as database, database.transaction():
        database.objects.add(Object("thing"))
    return path


@pytest.fixture
def run(path, monkeypatch, capsys):
    """run(program, "word", ...) runs a command: exit code, stdout and stderr."""

    def command(program, *words):
        monkeypatch.setattr("sys.argv", ["program", "--database", path, *map(str, words)])
        try:
            code = program.main()
        except SystemExit as error:
            code = error.code
        return (code, *capsys.readouterr())

    return command


def observations_in(path):
    with Database(path) as database:
        one = database.objects.find("thing")
        sessions = database.observations.sessions(one.id)
        return [seen for session in sessions for seen in database.observations.of(session.id)]


def mesh_in(path):
    with Database(path) as database:
        stored = database.meshes.of(database.objects.find("thing").id)
        return stored and unpack_mesh(stored.converted)


def in_frame(pose):
    """A plate's pose as that of the frame that observations are in."""
    return pose @ turntable.plate_frame()


@pytest.fixture(scope="module")
def captured(tmp_path_factory, folder, plate):
    """A database with the views of a whole turn, and a mesh of them."""
    path = str(tmp_path_factory.mktemp("captured") / "objects.db")
    with Database(path, write=True) as database, database.transaction():
        database.objects.add(Object("thing"))
    words = ["--database", path, "thing", plate, "--folder", folder, "--views", str(VIEWS)]
    object_capture.capture(object_capture.parse_arguments([*words, "--commit"]))
    return path


def test_views_have_poses_masks_and_depths_of_the_truth(captured, frames):
    seen = observations_in(captured)
    assert len(seen) == VIEWS
    for observation, frame in zip(seen, frames):
        view = seen_by(observation)
        shift, turn = pose_error(view.pose, in_frame(frame.pose))
        assert shift < 1.5 and turn < 0.3
        overlap, pixels = turntable.overlap(view.mask, frame.mask)
        assert overlap > 0.9 and pixels > 5000  # its lowest 5 mm are not told from the plate
        assert np.array_equal(view.image, frame.image)
        assert np.array_equal(view.depth, frame.depth)
        assert np.allclose(view.camera.K, turntable.CAMERA.K)
        assert np.allclose(view.camera.D, turntable.LENS)


def test_a_mesh_is_made_of_them(captured):
    mesh = mesh_in(captured)
    extent = mesh_extent(mesh)
    # The truth is turned about z, as the frame of observations has the first tag's x axis.
    vertices = mesh.vertices @ turntable.plate_frame()[:3, :3].T - [0.0, 0.0, SIZE[2] / 2.0]
    away = np.abs(vertices) - SIZE / 2.0
    outside = np.linalg.norm(np.maximum(away, 0.0), axis=1)
    distance = outside + np.abs(np.minimum(away.max(axis=1), 0.0))
    assert np.median(distance) < 0.0012 and np.quantile(distance, 0.99) < 0.006
    assert abs(np.asarray(extent.size)[2] - SIZE[2]) < 0.004
    assert_closed(mesh)
    colors = mesh.colors.astype(float)
    assert colors.std(axis=0).min() > 15.0  # It has labels, and not one color.


def assert_closed(mesh):
    """Each edge is there once in each direction, as often as the other."""
    edges = np.concatenate([mesh.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    there, counts = np.unique(edges, axis=0, return_counts=True)
    back, back_counts = np.unique(edges[:, ::-1], axis=0, return_counts=True)
    assert np.array_equal(there, back) and np.array_equal(counts, back_counts)


PAD = np.array([0.16, 0.16, 0.015])  # m, what the object stands on


def on_a_pad():
    parts = box(PAD, 4), standing_box()
    heights = PAD[2] / 2.0, PAD[2]
    first = [0, len(parts[0].vertices)]
    return Mesh(
        np.concatenate(
            [part.vertices + np.float32([0, 0, up]) for part, up in zip(parts, heights)]
        ),
        np.concatenate([part.triangles + offset for part, offset in zip(parts, first)]),
        texture_coordinates=np.concatenate([part.texture_coordinates for part in parts]),
        textures=[*parts[0].textures, *parts[1].textures],
        triangle_textures=np.concatenate(
            [parts[0].triangle_textures, parts[1].triangle_textures + len(parts[0].textures)]
        ),
    )


def test_what_is_below_the_floor_is_no_part_of_the_mesh(run, path, plate, tmp_path):
    """Depths show the pad around the object within the volume of the mesh."""
    frames = turntable.Turntable(on_a_pad()).turn(4)
    folder = turntable.write_frames(tmp_path / "frames", frames)
    words = ("thing", plate, "--folder", folder, "--views", 4, "--floor", 0.02, "--commit")
    assert run(object_capture, *words)[0] == 0
    vertices = mesh_in(path).vertices @ turntable.plate_frame()[:3, :3].T
    low = vertices[vertices[:, 2] < PAD[2]]
    away = np.abs(low[:, :2]) - SIZE[:2] / 2.0
    assert len(low) > 500 and np.quantile(away.max(axis=1), 0.99) < 0.003


def ork_file(tmp_path):
    file = tmp_path / "training.ork"
    file.write_text("pipeline1: {type: TodTrainer, object_ids: all}")
    return file


def test_its_texture_is_learned_and_found(captured, table, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(
        "sys.argv", ["training", "--database", captured, "-c", str(ork_file(tmp_path))]
    )
    assert training.main() == 0
    assert f"thing: TOD: {VIEWS} views learned" in capsys.readouterr().out
    assert training.main() == 0
    assert "nothing has changed" in capsys.readouterr().out
    with Database(captured) as database:
        data = database.models.of(database.objects.find("thing").id, "TOD").data
    matcher = TextureMatcher()
    matcher.add(TextureModel.from_bytes(data))
    for with_depth, limits in ((False, (12.0, 3.0)), (True, (6.0, 3.0))):
        frame = table.frame(1.1, elevation=0.55, distance=0.6)
        depth = frame.depth if with_depth else None
        found = matcher.match(frame.image, depth, turntable.CAMERA)
        shift, turn = pose_error(found[0].pose, in_frame(frame.pose))
        assert found[0].probability > 0.9 and shift < limits[0] and turn < limits[1]


def test_the_recognizer_verifies_it_by_the_mesh(captured, table, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(
        "sys.argv", ["training", "--database", captured, "-c", str(ork_file(tmp_path))]
    )
    assert training.main() == 0
    loaded = load_objects(captured, [], ["TOD"])
    assert loaded.problem == "" and loaded.lacks == [] and not loaded.objects[0].is_box
    assert_recognized(loaded, table)


def assert_recognized(loaded, table):
    recognizer = Recognizer(loaded.objects, RecognitionParams.defaults())
    frame = table.frame(2.6, elevation=0.6, distance=0.6)
    camera, image, depth = straight(frame)
    found, told = recognizer.recognize(image, depth, camera)
    assert [one.object.name for one in found] == ["thing"], told
    shift, turn = pose_error(found[0].pose, in_frame(frame.pose))
    assert shift < 8.0 and turn < 3.0
    assert told["thing"].startswith("found 1, probability ")


def straight(frame):
    """A frame as a camera without distortion would see it."""
    known = turntable.CAMERA
    camera = CameraModel(known.width, known.height, known.K)
    size = known.width, known.height
    matrix = np.asarray(known.K)
    lens = np.array(turntable.LENS)
    maps = cv2.initUndistortRectifyMap(matrix, lens, None, matrix, size, cv2.CV_32FC1)
    image = cv2.remap(frame.image, *maps, cv2.INTER_LINEAR)
    return camera, image, cv2.remap(frame.depth, *maps, cv2.INTER_NEAREST)


def test_without_a_mesh_it_is_judged_by_its_texture(run, path, folder, plate, table, tmp_path):
    words = ("thing", plate, "--folder", folder, "--views", VIEWS, "--commit", "--no-mesh")
    assert run(object_capture, *words)[0] == 0
    assert mesh_in(path) is None
    code, _, err = run(training, "-c", ork_file(tmp_path))
    assert (code, err) == (0, "")
    loaded = load_objects(path, [], ["TOD"])
    assert loaded.problem == "" and loaded.objects[0].is_box
    assert_recognized(loaded, table)


def test_a_mesh_that_somebody_gave_stays(run, path, folder, plate, tmp_path, monkeypatch):
    given = standing_box()
    file = tmp_path / "captured.ply"  # as those are called that are made of observations
    write_mesh(str(file), given)
    words = ("thing", plate, "--folder", folder, "--views", 4, "--commit")
    assert run(mesh_add, "thing", file, "--commit")[0] == 0
    code, out, _ = run(object_capture, *words)
    assert code == 0 and "a mesh of" not in out
    assert np.allclose(mesh_extent(mesh_in(path)).size, SIZE, atol=1e-6)
    with Database(path, write=True) as database, database.transaction():
        database.meshes.delete(database.objects.find("thing").id)
    usual = captured_mesh.pack_mesh

    def given_meanwhile(mesh):
        mesh_add.add(mesh_add.parse_arguments(["--database", path, "thing", str(file), "--commit"]))
        return usual(mesh)

    monkeypatch.setattr(captured_mesh, "pack_mesh", given_meanwhile)
    code, out, _ = run(object_capture, *words, "--replace")
    assert code == 0 and out.endswith("'thing' was given a mesh meanwhile, which stays\n")
    assert np.allclose(mesh_extent(mesh_in(path)).size, SIZE, atol=1e-6)


@pytest.mark.parametrize(
    "words, where",
    [
        ((), "the middle of the tags"),
        (("--center", 0.1, -0.02), "x 0.1 and y -0.02 m"),
    ],
)
def test_where_the_object_has_to_stand_is_told(run, plate, words, where):
    _, out, _ = run(object_capture, "thing", plate, "--folder", "/none", "--radius", 0.05, *words)
    assert out == f"'thing' is what stands within 50 mm of {where} of 'plate'\n"


def test_a_trial_stores_nothing(run, path, folder, plate):
    code, out, err = run(object_capture, "thing", plate, "--folder", folder, "--views", 4)
    assert (code, err) == (0, "")
    assert "4 of 4 views, would be stored" in out and "--commit" in out
    assert observations_in(path) == [] and mesh_in(path) is None


def test_what_is_there_is_only_replaced_or_added_to_if_that_is_said(
    run, path, folder, plate, table, tmp_path
):
    words = ("thing", plate, "--folder", folder, "--views", 4, "--commit", "--no-mesh")
    higher = turntable.write_frames(tmp_path / "higher", table.turn(4, elevation=0.85))
    assert run(object_capture, *words)[0] == 0
    first = {one.session_id for one in observations_in(path)}
    code, _, err = run(object_capture, *words)
    assert code == 1 and "has 4 observations already: --replace replaces them, --add" in err
    assert run(object_capture, *words, "--folder", higher, "--add")[0] == 0
    assert len(observations_in(path)) == 8
    assert run(object_capture, *words, "--replace")[0] == 0
    assert len(observations_in(path)) == 4
    assert not first.intersection(one.session_id for one in observations_in(path))


def test_a_mesh_goes_with_the_views_that_it_was_made_of(run, path, folder, plate, monkeypatch):
    words = ("thing", plate, "--folder", folder, "--views", 4, "--commit")
    assert run(object_capture, *words)[0] == 0 and mesh_in(path) is not None
    interrupt(monkeypatch, 2)
    assert run(object_capture, *words, "--replace")[0] == 130
    assert 0 < len(observations_in(path)) < 4 and mesh_in(path) is None
    monkeypatch.undo()


def interrupt(monkeypatch, count):
    """Has the next runs see this many frames, and then Ctrl-C."""

    def shots(arguments):
        for number, shot in enumerate(object_capture.shots_from_folder(arguments.folder)):
            if number == count:
                raise KeyboardInterrupt
            yield shot

    monkeypatch.setattr(object_capture, "_shots", shots)


LEARN = ". What is there can be learned as it is; --add takes the rest"


def test_after_ctrl_c_what_was_taken_is_there_and_add_takes_the_rest(
    run, path, folder, plate, monkeypatch
):
    words = ("thing", plate, "--folder", folder, "--views", VIEWS, "--commit", "--no-mesh")
    with monkeypatch.context() as now:
        interrupt(now, 5)
        code, out, _ = run(object_capture, *words)
    assert code == 130 and f"interrupted; 5 of {VIEWS} views, missing at" in out
    assert f" degrees, stored{LEARN}" in out
    assert len(observations_in(path)) == 5
    assert all(seen_by(one).mask.any() for one in observations_in(path))
    code, out, err = run(object_capture, *words, "--add")
    assert (code, err) == (0, "") and f"{VIEWS} of {VIEWS} views, stored" in out
    assert [one.frame_number for one in observations_in(path)] == [*range(1, VIEWS + 1)]


@pytest.mark.parametrize(
    "words, count, said",
    [
        ((), 2, f"interrupted; 2 of {VIEWS} views, missing at 0-283 degrees, would be stored\n"),
        (("--commit",), 0, f"interrupted; 0 of {VIEWS} views, missing at 0-360 degrees\n"),
    ],
)
def test_after_ctrl_c_nothing_that_is_not_there_is_told(
    run, path, folder, plate, monkeypatch, words, count, said
):
    interrupt(monkeypatch, count)
    code, out, _ = run(object_capture, "thing", plate, "--folder", folder, "--views", VIEWS, *words)
    assert code == 130 and out.endswith(said)
    assert observations_in(path) == []


@pytest.mark.parametrize(
    "error, code, said",
    [
        (OSError("No space left"), 1, "object_capture.py: No space left\n"),
        (KeyboardInterrupt(), 130, ""),
    ],
)
def test_why_the_first_view_was_not_stored_is_told(
    run, path, folder, plate, monkeypatch, error, code, said
):
    usual, errors = Observations.add, [error] * (1 if code == 130 else 99)

    def failing(self, new):
        if errors:
            raise errors.pop()
        usual(self, new)

    monkeypatch.setattr(Observations, "add", failing)
    words = ("thing", plate, "--folder", folder, "--views", VIEWS, "--commit", "--no-mesh")
    found, out, err = run(object_capture, *words)
    assert (found, err) == (code, said)
    stored = 1 if code == 130 else 0
    assert len(observations_in(path)) == stored
    assert (f"interrupted; 1 of {VIEWS} views" in out) == (code == 130)


def test_a_folder_whose_name_is_no_utf_8(run, path, plate, frames, tmp_path):
    folder = tmp_path / os.fsdecode(b"caf\xe9")  # which cv2.imwrite() could not name
    os.rename(turntable.write_frames(tmp_path / "frames", frames[:1]), folder)
    words = ("thing", plate, "--folder", folder, "--commit", "--no-mesh")
    code, _, err = run(object_capture, *words)
    assert (code, err) == (0, "") and len(observations_in(path)) == 1
    with Database(path) as database:
        (session,) = database.observations.sessions(database.objects.find("thing").id)
    assert session.source == str(tmp_path / "caf?")


def test_a_bag_gives_the_same_views(run, path, plate, frames, tmp_path):
    bag_path = str(tmp_path / "turn.bag")
    with rosbag.Bag(bag_path, "w") as bag:
        for number, frame in enumerate(frames[:3]):
            stamp = rospy.Time(10 + number)
            for topic, pixels, encoding in (
                ("/eye/image_raw", frame.image, "bgr8"),
                ("/eye/depth", frame.depth, "16UC1"),
            ):
                image = message(pixels, encoding)
                image.header.stamp = stamp
                bag.write(topic, image, stamp)
            info = info_of(turntable.CAMERA)
            info.binning_x = info.binning_y = 2  # which some drivers tell of the images themselves
            bag.write("/eye/camera_info", info, stamp)
    topics = ("--image", "/eye/image_raw", "--depth", "/eye/depth")
    words = ("thing", plate, "--bag", bag_path, *topics, "--views", VIEWS)
    code, out, err = run(object_capture, *words, "--commit", "--no-mesh")
    assert (code, err) == (0, "") and f"3 of {VIEWS} views, missing at" in out
    seen = observations_in(path)
    assert [one.frame_number for one in seen] == [1, 2, 3]
    assert np.array_equal(seen_by(seen[1]).image, frames[1].image)
    wrong = ("--image", "/eye/image_raw", "--depth", "/eye/deep")
    code, _, err = run(object_capture, "thing", plate, "--bag", bag_path, *wrong, "--add")
    assert code == 1 and "has no images on '/eye/deep', but on /eye/depth, /eye/image_raw" in err


def info_of(camera):
    return CameraInfo(
        width=camera.width,
        height=camera.height,
        K=np.ravel(camera.K).tolist(),
        D=list(camera.D),
        distortion_model="plumb_bob",
    )


def test_what_is_missing_is_told(run, path, folder, plate, frames, tmp_path):
    folders = {
        "tags": (np.full_like(frames[0].image, 120), frames[0].depth),
        "nothing": (frames[0].image, np.full_like(frames[0].depth, 0)),
    }
    for name, problem in (
        ("tags", "no tag of the plate is seen"),
        ("nothing", "there is nothing on the plate, or it has no depth"),
    ):
        image, depth = folders[name]
        bad = [frames[0]._replace(image=image, depth=depth)] * 2
        where = turntable.write_frames(tmp_path / name, bad)
        code, _, err = run(object_capture, "thing", plate, "--folder", where, "--commit")
        assert code == 1
        assert (
            f"no view of the object in 2 frames; 2 frames were not used, most (2): {problem}" in err
        )
    assert observations_in(path) == []


def test_frames_that_cannot_be_used_are_left_out(run, path, plate, frames, tmp_path, monkeypatch):
    folder = pathlib.Path(turntable.write_frames(tmp_path / "frames", frames[:4]))
    images = sorted((folder / "rgb").iterdir())
    images[0].write_bytes(images[0].read_bytes()[:1000])
    cv2.imwrite(str(images[2]), frames[2].image[:-1])
    words = ("thing", plate, "--folder", folder, "--views", VIEWS, "--commit", "--no-mesh")
    code, out, err = run(object_capture, *words)
    assert (code, err) == (0, "") and f"2 of {VIEWS} views" in out and "; 2 frames were not" in out
    assert [one.frame_number for one in observations_in(path)] == [2, 4]
    for image in images:
        cv2.imwrite(str(image), frames[2].image[:-1])
    height, width = frames[2].image.shape[:2]
    said = f"its image is of {width}x{height - 1}, camera_info of {width}x{height}\n"
    code, _, err = run(object_capture, *words, "--add")
    told = "no view of the object in 4 frames; 4 frames were not used, most (4)"
    assert (code, err) == (1, f"object_capture.py: {told}: {said}")
    monkeypatch.setattr(capture_run, "MAX_UNUSABLE", 2)  # as of topics, whose frames never end
    code, _, err = run(object_capture, *words, "--add")
    assert (code, err) == (1, f"object_capture.py: {images[1]}: {said}")
    assert len(observations_in(path)) == 2


@pytest.mark.parametrize(
    "words, code, message",
    [
        (("thing", "{plate}", "--image", "/image"), 2, "only depths tell what of an image"),
        (("thing", "{plate}"), 2, "the images are missing: --image and --depth, or --folder"),
        (("cup", "{plate}", "--folder", "{folder}"), 1, "cup"),
        (("thing", "nowhere.yaml", "--folder", "{folder}"), 1, "nowhere.yaml"),
        (("thing", "{plate}", "--folder", "/nowhere"), 1, "/nowhere"),
        (("thing", "{plate}", "--folder", "{folder}", "--bundle-name", "x"), 1, "none of the name"),
        (("thing", "{plate}", "--folder", "{folder}", "--family", "x"), 2, "argument --family"),
        (("thing", "{plate}", "--folder", "{folder}", "--views", "2"), 2, "from 4 to 360"),
        (("thing", "{plate}", "--folder", "{folder}", "--center", "0", "nan"), 2, "from -3 to 3 m"),
        (("thing", "{plate}", "--folder", "{folder}", "--center", "inf", "0"), 2, "from -3 to 3 m"),
        (("thing", "{plate}", "--folder", "{folder}", "--floor", "0.6"), 2, "below --height"),
        (
            ("thing", "{plate}", "--folder", "{folder}", "--camera-info", "/eye/camera_info"),
            2,
            "--camera-info must be a .yaml file: nobody publishes with --folder",
        ),
    ],
)
def test_wrong_arguments_say_what_is_wrong(run, plate, folder, words, code, message):
    given = [word.format(plate=plate, folder=folder) for word in words]
    result, _, err = run(object_capture, *given)
    assert result == code and message in err and "Traceback" not in err


def test_a_plate_is_where_its_tags_are(plate):
    found = plate_of(read_plate_bundle(plate, "", "tag36h11"))
    poses = turntable.tag_poses()
    truth = np.linalg.inv(poses[turntable.FIRST]) @ turntable.plate_frame()
    assert np.allclose(found.frame, truth, atol=1e-5)
    corner = turntable.RING - turntable.TAG * np.sqrt(0.5)
    assert corner < found.radius < turntable.RING - turntable.TAG / 2.0 + 1e-6
    other = plate_of(read_plate_bundle(plate, "plate", ""), truth[:2, 3] + [0.01, 0.0], 0.05)
    assert np.allclose(other.frame[:3, 3], truth[:3, 3] + [0.01, 0.0, 0.0], atol=1e-5)
    assert other.radius == 0.05


def tilted_plate(path, degrees):
    """The plate's tags in a frame whose x-y plane is tilted against it, and the tilt."""
    tilt = np.eye(4)
    tilt[:3, :3] = cv2.Rodrigues(np.radians([degrees, 0.0, 0.0]))[0]
    tags = turntable.bundle().tags
    tags = [BundleTag(one.id, one.size, tilt @ one.pose, 0.0, 0.0) for one in tags]
    write_bundles(str(path), [Bundle("plate", tags)], turntable.FAMILY)
    return read_plate_bundle(str(path), "", ""), tilt


def test_the_center_has_its_x_and_y_in_a_frame_that_is_tilted(tmp_path):
    tags, tilt = tilted_plate(tmp_path / "tilted.yaml", 20.0)
    place = plate_of(tags, (0.01, 0.1), 0.05).frame[:3, 3]
    assert np.allclose(place[:2], (0.01, 0.1), atol=1e-6)
    assert abs((tilt[:3, :3].T @ place)[2]) < 1e-6
    tags, _ = tilted_plate(tmp_path / "upright.yaml", 88.0)
    with pytest.raises(ValueError, match="center tells no place on the plate, which is upright"):
        plate_of(tags, (0.01, 0.1), 0.05)


def test_tags_on_no_plane_are_no_plate(plate, tmp_path):
    lines = pathlib.Path(plate).read_text().splitlines()
    lines[-1] = lines[-1].replace("z: ", "z: 0.03, shift_noise: 0.001} # ")
    bad = tmp_path / "bent.yaml"
    bad.write_text("\n".join(lines))
    with pytest.raises(
        ValueError, match="from the plane of all of them, must be on the upper side"
    ):
        plate_of(read_plate_bundle(str(bad), "", "tag36h11"))
