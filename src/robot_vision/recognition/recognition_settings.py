"""The live parameters of the node object_recognizer."""

from typing import Any, Dict, List, NamedTuple, Optional, Sequence

from .. import (
    DepthErrorParams,
    ObjectMatchParams,
    PlaneParams,
    PointPairMatchParams,
    RecognizerParams,
    RefinerParams,
    TabletopParams,
    TextureMatchParams,
    VerifierParams,
    validate,
)
from ..common.plain_text import NAME, brief, is_name
from ..ros.live_params import filled
from ..ros.params import read_param
from .found import Limits
from .methods import known_methods, method_of
from .recognizer import RecognitionParams

MAX_THREADS = 64  # of ObjectMatchParams
SIDES = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")


class Settings(NamedTuple):
    """The live parameters; each change makes new ones."""

    params: RecognitionParams
    objects: Sequence[str]  # ids and names; none: all
    limits: Optional[Limits]
    on_tables: bool
    planes: PlaneParams
    tables: TabletopParams
    vertical_frame: str
    rectified: bool
    publish_tf: bool


def settings_of(config: Dict[str, Any]) -> Settings:
    """Returns the settings for values by their names.

    Raises:
        ValueError: A value cannot be.
    """
    params = RecognitionParams(
        *(
            filled(kind(), config)
            for kind in (
                ObjectMatchParams,
                PointPairMatchParams,
                TextureMatchParams,
                RecognizerParams,
                RefinerParams,
                VerifierParams,
                DepthErrorParams,
            )
        )
    )
    params.match.threads = MAX_THREADS  # as many of them as ~threads allows
    planes, tables = PlaneParams(), TabletopParams()
    for one in (*params, planes, tables):
        validate(one)
    frame = config["vertical_frame"]
    if frame and not is_name(frame):
        raise ValueError(f"vertical_frame is {brief(frame)}, must be empty or {NAME}")
    names = [name.strip() for name in config["objects"].split(",") if name.strip()]
    return Settings(
        params,
        tuple(names),
        _limits(config),
        config["on_tables"],
        planes,
        tables,
        frame,
        config["rectified"],
        config["publish_tf"],
    )


def _limits(config: Dict[str, Any]) -> Optional[Limits]:
    if not config["crop"]:
        return None
    for axis in "xyz":
        low, high = config[f"{axis}_min"], config[f"{axis}_max"]
        if low > high:
            raise ValueError(f"{axis}_min is {low:g}, must be at most {axis}_max, {high:g}")
    low, high = ([config[f"{axis}_{end}"] for axis in "xyz"] for end in ("min", "max"))
    return Limits(low, high)


def read_methods() -> List[str]:
    """Returns ~methods, the names of those that have learned the objects.

    Raises:
        ValueError: One of them is not there.
    """
    value = read_param("methods", "LINEMOD")
    names = list(dict.fromkeys(name.strip() for name in value.split(",") if name.strip()))
    try:
        for name in names:
            method_of(name)
    except ValueError:
        raise ValueError(
            f"methods is {brief(value)}, must be names of methods between commas: {known_methods()}"
        ) from None
    return names
