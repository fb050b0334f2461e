"""Live parameters in the core's structs, by their names."""

import pytest

from robot_vision import FaceParams, MotionParams
from robot_vision.ros.live_params import attribute_of, filled


@pytest.mark.parametrize(
    "name, prefix, attribute",
    [
        ("min_area", "", "min_area"),
        ("minArea", "", "min_area"),
        ("haar_scaleFactor", "haar_", "scale_factor"),
        ("haar_scaleFactor", "", "haar_scale_factor"),
        ("hold", "haar_", "hold"),
    ],
)
def test_the_core_s_names(name, prefix, attribute):
    assert attribute_of(name, prefix) == attribute


def test_what_the_struct_has_is_filled_in():
    config = {"minArea": 7.0, "blur_size": 3, "hold": 2.0, "groups": {}}
    params = filled(MotionParams(), config)
    assert (params.min_area, params.blur_size) == (7.0, 3)
    assert params.threshold == MotionParams().threshold
    assert not hasattr(params, "hold")


def test_a_prefix_is_not_the_core_s():
    config = {"haar_minSize": 9, "cascade_2": "", "hold": 2.0}
    params = filled(FaceParams(), config, "haar_")
    assert (params.min_size, params.cascade_2, params.hold) == (9, "", 2.0)


def test_another_type_is_refused():
    with pytest.raises(TypeError):
        filled(MotionParams(), {"blur_size": "large"})
