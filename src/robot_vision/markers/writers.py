"""Writers of drawings as PDF, SVG and PNG."""

import io
import math
import struct
import zlib
from typing import Sequence
from xml.sax.saxutils import escape

import cairo
import cv2
import numpy as np

from .drawing import INCH, Drawing

POINT = INCH / 72.0  # mm, the unit of cairo in a PDF
FONT = "sans-serif"
PNG_HEADER = 33  # bytes: the signature, and the chunk with the size of the image
MAX_SIDE = 32767  # px, largest side of an image of cairo


def to_pdf(pages: Sequence[Drawing]) -> bytes:
    """Returns a PDF with all pages."""
    data = io.BytesIO()
    surface = cairo.PDFSurface(data, pages[0].width / POINT, pages[0].height / POINT)
    for page in pages:
        surface.set_size(page.width / POINT, page.height / POINT)
        context = cairo.Context(surface)
        context.scale(1.0 / POINT, 1.0 / POINT)
        paint(context, page)
        surface.show_page()
    surface.finish()
    return data.getvalue()


def to_png(page: Drawing, dpi: int) -> bytes:
    """Returns a gray PNG with its resolution; all edges of bars are at the edges of pixels.

    Raises:
        ValueError: The image would have too many pixels.
    """
    scale = dpi / INCH
    width, height = round(page.width * scale), round(page.height * scale)
    if max(width, height) > MAX_SIDE:
        raise ValueError(f"at {dpi} dpi it is {width}x{height} px, must be at most {MAX_SIDE}")
    surface = cairo.ImageSurface(cairo.FORMAT_A8, width, height)
    context = cairo.Context(surface)
    context.set_antialias(cairo.ANTIALIAS_NONE)
    context.scale(scale, scale)
    paint(context, page)
    surface.flush()
    ink = np.frombuffer(surface.get_data(), np.uint8).reshape(height, surface.get_stride())
    return png(255 - ink[:, :width], dpi)


def paint(context: cairo.Context, page: Drawing) -> None:
    """Draws a page on a context whose unit is the millimetre."""
    context.set_source_rgba(0.0, 0.0, 0.0, 1.0)
    # All bars are one shape, because viewers show thin lines between shapes that touch.
    for bar in page.bars:
        context.rectangle(*bar)
    context.fill()
    context.save()
    context.set_antialias(cairo.ANTIALIAS_GRAY)  # so that the middle of a disc is where it should
    for x, y, radius in page.discs:
        context.new_sub_path()
        context.arc(x, y, radius, 0.0, 2.0 * math.pi)
        context.fill()
    context.restore()
    context.select_font_face(FONT)
    for text in page.texts:
        context.set_font_size(text.size)
        context.move_to(text.x - context.text_extents(text.text)[4] / 2.0, text.y)
        context.show_text(text.text)


def png(gray: np.ndarray, dpi: int) -> bytes:
    """Returns a PNG of a (height, width) uint8 image with the resolution in its pHYs chunk."""
    data = cv2.imencode(".png", gray, [cv2.IMWRITE_PNG_COMPRESSION, 9])[1].tobytes()
    per_metre = round(dpi / INCH * 1000.0)
    size = struct.pack(">4sIIB", b"pHYs", per_metre, per_metre, 1)
    chunk = struct.pack(">I", len(size) - 4) + size + struct.pack(">I", zlib.crc32(size))
    return data[:PNG_HEADER] + chunk + data[PNG_HEADER:]


def to_svg(page: Drawing) -> bytes:
    """Returns an SVG whose unit is the millimetre; the unit of cairo's depends on its version."""
    size = f"{page.width:.4f}", f"{page.height:.4f}"
    bars = "".join(f"M{x:.4f} {y:.4f}h{w:.4f}v{h:.4f}h{-w:.4f}z" for x, y, w, h in page.bars)
    discs = "".join(
        f'<circle cx="{x:.4f}" cy="{y:.4f}" r="{radius:.4f}"/>\n' for x, y, radius in page.discs
    )
    texts = "".join(
        f'<text x="{text.x:.4f}" y="{text.y:.4f}" font-size="{text.size:.4f}" '
        f'font-family="{FONT}" text-anchor="middle">{escape(text.text)}</text>\n'
        for text in page.texts
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{size[0]}mm" height="{size[1]}mm" '
        f'viewBox="0 0 {size[0]} {size[1]}">\n'
        '<rect width="100%" height="100%" fill="white"/>\n'
        f'<path d="{bars}"/>\n{discs}{texts}</svg>\n'
    ).encode()
