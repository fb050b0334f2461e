"""The node cube_overlay, which stands a cube on a calibration board."""

from dataclasses import fields
from typing import Any, Dict, Optional

from geometry_msgs.msg import PoseStamped
from std_msgs.msg import Float64
from tf2_msgs.msg import TFMessage

from .. import CameraModel, draw_text, to_bgr, to_gray
from ..common.plain_text import brief
from ..ros.camera_info import NOT_CALIBRATED, CameraInfoListener
from ..ros.configs import CubeOverlayConfig
from ..ros.image_node import ImageNode
from ..ros.live_params import LiveParams
from ..ros.params import read_name
from ..ros.poses import pose_of, transform_of
from ..ros.startup import run_node
from ..ros.transform_output import TransformOutput
from ..ros.transport import KEPT, Frame, FrameError, note_connections
from .board_pose import BoardPose, Orientation, quarter_turns, solve_pose
from .board_search import BoardParams, BoardSearch, make_board
from .cube_drawing import draw_axes, draw_cube

DRAWINGS = ("cube", "axes")
BOARD = tuple(field.name for field in fields(BoardParams))


class CubeOverlay:
    """Publishes ~pose, ~reprojection_error, /tf and ~processed_image (a cube on the board).

    Subscribes to image, and to camera_info beside it, or where that name is remapped to. Poses need
    the camera_info of a calibrated camera.
    """

    def __init__(self) -> None:
        self._frame_id = read_name("board_frame_id", "board")
        self._board: Optional[BoardParams] = None
        self._publish_tf = True
        self._node = ImageNode(self._process, encoding="")
        self._params = LiveParams(CubeOverlayConfig, self._configure)
        self._calibration = CameraInfoListener(self._node, "poses of the board")
        self._poses = self._node.publisher("~pose", PoseStamped)
        self._errors = self._node.publisher("~reprojection_error", Float64)
        self._tf = TransformOutput(self._node, lambda: self._publish_tf)
        self._processed = self._node.image_publisher("~processed_image")
        self._node.start()

    def _configure(self, config: Dict[str, Any]) -> None:
        if config["draw"] not in DRAWINGS:
            what = brief(config["draw"])
            raise ValueError(f"draw is {what}, must be {' or '.join(DRAWINGS)}")
        params = BoardParams(**{name: config[name] for name in BOARD})
        if params != self._board:  # A new search has lost the board.
            board = make_board(params)
            search = BoardSearch(board, params.search_size, params.search_period)
            turns = quarter_turns(params.board, params.columns, params.rows, board)
            # Replaced in one step, because another thread may be processing a frame.
            self._tools = board, search, Orientation(turns)
            self._board = params
        self._max_error = config["max_error"]
        self._drawing = config["draw"], config["size"] * config["square"]
        self._publish_tf = config["publish_tf"]
        note_connections()  # because /tf may start or stop to count

    def _process(self, frame: Frame) -> Any:
        camera = self._calibration.camera(frame.image.shape[1::-1])
        found = self._locate(frame, camera) if camera else None
        if found:
            self._publish(frame, found)
        if self._processed.get_num_connections():
            try:
                overlay = to_bgr(frame.image, frame.encoding)
            except (TypeError, ValueError) as error:
                raise FrameError(error) from None
            if camera is None:
                draw_text(overlay, NOT_CALIBRATED, (10, 20))
            elif found:
                kind, length = self._drawing
                draw = draw_cube if kind == "cube" else draw_axes
                draw(overlay, found.pose, length, camera)
                x, y, z = found.pose[:3, 3]
                draw_text(overlay, f"x {x:+.3f} y {y:+.3f} z {z:.3f} m", (10, 20))
                draw_text(overlay, f"error {found.error:.2f} px", (10, 40))
            self._processed.publish(overlay, "bgr8", frame.header)
        if camera is not None:
            return None
        self._calibration.refuse()
        return KEPT

    def _locate(self, frame: Frame, camera: CameraModel) -> Optional[BoardPose]:
        board, search, orientation = self._tools
        try:
            gray = to_gray(frame.image, frame.encoding)
        except (TypeError, ValueError) as error:
            raise FrameError(error) from None
        observation = search.find(frame.time, gray)
        solved = solve_pose(board, observation, camera) if observation else None
        if solved is None or solved.error > self._max_error:
            return None
        return solved._replace(pose=orientation.continued(frame.time, solved.pose))

    def _publish(self, frame: Frame, found: BoardPose) -> None:
        self._poses.publish(PoseStamped(frame.header, pose_of(found.pose)))
        self._errors.publish(found.error)
        if self._tf.is_wanted():
            self._tf.publish(TFMessage([transform_of(frame.header, self._frame_id, found.pose)]))


def main() -> None:
    run_node("cube_overlay", CubeOverlay)
