"""A page of HTML that shows the database: objects, and their meshes from several sides."""

import base64
import html
from typing import Any, List, Tuple

import numpy as np

from .. import mesh_extent
from ..common import opencv as cv2
from ..common.plain_text import printable
from ..meshes import mesh_sheet
from .database import Database, Object
from .mesh_data import unpack_mesh
from .symmetries import symmetry_text

Rows = List[Tuple[str, str]]  # the name and the text of each

QUALITY = 85  # of the JPEGs, in percent
STYLE = """
body { font-family: sans-serif; margin: 2em auto; max-width: 60em; color: #222 }
section { border-top: 1px solid #bbb; padding: 1em 0 }
h2 { margin: 0 } code { color: #666 }
img { max-width: 100%; display: block; margin: 1em 0 }
th { text-align: left; padding-right: 1em; vertical-align: top; font-weight: normal; color: #666 }
"""
PAGE = """<!DOCTYPE html>
<html lang="en">
<head><meta charset="utf-8"><title>{title}</title><style>{style}</style></head>
<body>
<h1>{title}</h1>
{body}
</body>
</html>
"""


def page_of(database: Database, damaged: List[str]) -> str:
    """Returns a page that needs no other file, and adds to `damaged` what cannot be read."""
    objects = database.objects.all()
    count = f"{len(objects)} object{'s' * (len(objects) != 1)}"
    title = f"{count} in {html.escape(_shown(database.path))}"
    sections = [_section(database, one, damaged) for one in objects]
    return PAGE.format(title=title, style=STYLE, body="\n".join(sections))


def _section(database: Database, one: Object, damaged: List[str]) -> str:
    rows: Rows = [
        ("description", one.description),
        ("tags", ", ".join(one.tags)),
        ("author", " ".join(filter(None, [one.author, one.email]))),
        ("added", one.added),
    ]
    image = ""
    try:
        more, image = _learned_by(database, one)
        rows += more
    except ValueError as error:
        damaged.append(f"'{printable(one.name)}' {one.id[:8]}: {error}")
        rows.append(("damaged", str(error)))
    cells = "\n".join(
        f"<tr><th>{html.escape(name)}</th><td>{html.escape(_shown(value))}</td></tr>"
        for name, value in rows
        if value
    )
    name = f"<h2>{html.escape(one.name)} <code>{html.escape(one.id)}</code></h2>"
    return f"<section>\n{name}\n{image}\n<table>\n{cells}\n</table>\n</section>"


def _learned_by(database: Database, one: Object) -> Tuple[Rows, str]:
    """Returns what there is of an object beside its document, and the image of its mesh or ""."""
    rows: Rows = []
    image = ""
    entry = database.meshes.entry(one.id)
    if entry is not None:
        mesh = unpack_mesh(database.meshes.converted(one.id))
        rows += _mesh_rows(entry, mesh)
        image = f'<img alt="{html.escape(one.name)}" src="{_data_url(mesh_sheet(mesh))}">'
    else:
        rows.append(("mesh", "none"))
    for model in database.models.entries_of(one.id):
        rows.append((model.method, f"learned {model.added}"))
    seen = database.observations.count(one.id)
    return rows + ([("observations", str(seen))] if seen else []), image


def _mesh_rows(entry: Any, mesh: Any) -> Rows:
    size = " x ".join(f"{1000.0 * side:.1f}" for side in np.asarray(mesh_extent(mesh).size))
    symmetries = ", ".join(map(symmetry_text, entry.symmetries))
    return [
        ("mesh", f"{entry.file_name}: {len(mesh.triangles)} triangles, unit {entry.unit:g} m"),
        ("size", f"{size} mm"),
        ("symmetries", symmetries),
    ]


def _data_url(image: np.ndarray) -> str:
    jpeg = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])[1]
    return f"data:image/jpeg;base64,{base64.b64encode(jpeg.tobytes()).decode()}"


def _shown(text: str) -> str:
    return text.encode(errors="replace").decode()  # a path may have bytes that are no letters
