"""The commands of the course as they are typed there, from the first object to what is found."""

import re

import pytest
import rospy
import support
from calibrated_camera import info_of
from course_objects import FILES, FOLDER, CourseTable, needs_course_objects
from frames import Source, message
from sensor_msgs.msg import CameraInfo
from std_msgs.msg import Header
from tag_studio import matrix_of

from robot_vision.msg import RecognizedObjectArray
from robot_vision.recognition.database import Database

pytestmark = needs_course_objects


@pytest.fixture
def database(start, tmp_path, monkeypatch):
    """The file that the commands make in the user's folder, with the objects, learned."""
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    monkeypatch.chdir(FOLDER)

    def run(program, *words):
        process = start(program, *words)
        assert process.exit_code() == 0, process.output()
        return process.output()

    for name, file in FILES.items():
        said = run("object_add.py", "-n", name, "-d", f"A universal {name}", "--commit")
        (key,) = re.findall(r"\b[0-9a-f]{32}\b", said)
        run("mesh_add.py", key, file, "--symmetry", "z", "--commit")
    run("training", "-c", "training.ork")
    return tmp_path / "robot_vision_objects.db"


def test_detection_finds_what_the_commands_have_learned(start, database):
    table = CourseTable()
    image, depth = table.frame(0)
    sources = {
        Source("/camera/rgb/camera_info", CameraInfo): info_of(table.camera),
        Source("/camera/depth_registered/image_raw"): message(depth, "32FC1"),
        Source("/camera/rgb/image_raw"): message(image, "bgr8"),
    }
    out = support.Messages("/recognized_object_array", RecognizedObjectArray)
    start("detection", "-c", "detection.ros.ork")
    with Database(str(database)) as known:
        names = {known.objects.find(name).id: name for name in FILES}

    def found():
        header = Header(stamp=rospy.Time.now(), frame_id="camera_rgb_optical_frame")
        for source, sent in sources.items():
            sent.header = header
            source.send(sent)
        return [array for array in out.received if len(array.objects) >= len(FILES)]

    objects = support.wait_for(found, "both objects")[0].objects
    poses = {names[one.type.key]: matrix_of(one.pose.pose.pose) for one in objects}
    assert len(objects) == len(poses)
    table.require_poses(0, poses)
