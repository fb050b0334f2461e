"""The result of a calibration, as the page shows it."""

from typing import Any, Dict, List

from ..calibration.camera_file import as_yaml
from ..calibration.headless_steps import UNSURE, is_unsure, parameters_report
from ..calibration.solving import Calibration
from ..common.plain_text import error_text

CAMERA_NAME = "camera"  # in the file that the page offers


def result_of(found: Calibration) -> Dict[str, Any]:
    """Returns a result as the page shows it: lines, error (px), unsure, advice, and its file."""
    unsure = is_unsure(found)
    lines: List[str] = [*parameters_report(found), f"reprojection error: {found.error:.3f} px"]
    try:
        file = as_yaml(found, CAMERA_NAME)
    except ValueError as error:  # No camera would accept it.
        lines.append(error_text(error, 300))
        unsure, file = True, ""
    return {
        "lines": lines,
        "error": round(found.error, 4),
        "unsure": unsure,
        "advice": UNSURE if unsure else "",
        "yaml": file,
    }
