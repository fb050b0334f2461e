"""Small mesh files, and what to compare meshes by."""

import base64
import textwrap

import numpy as np

PYRAMID = np.array([[0, 0, 0], [0.3, 0, 0], [0, 0.2, 0], [0, 0, 0.1]])  # m
SIDES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def written(path, text):
    """Writes a text, without its indentation, and returns the path."""
    path.write_text(textwrap.dedent(text))
    return str(path)


def obj(path, vertices=PYRAMID, sides=SIDES, before="", between=""):
    """Writes an OBJ file of the pyramid, or of other vertices and sides."""
    lines = ["v " + " ".join(map(str, vertex)) for vertex in np.asarray(vertices).tolist()]
    faces = ["f " + " ".join(str(vertex + 1) for vertex in side) for side in sides]
    path.write_text("\n".join([before, *lines, between, *faces, ""]))
    return str(path)


def shape(mesh):
    """The triangles as places, in an order of their own."""
    corners = np.round(np.float64(mesh.vertices), 5)[mesh.triangles]
    turned = [
        min((tuple(map(tuple, np.roll(one, k, axis=0)))) for k in range(3)) for one in corners
    ]
    return sorted(turned)


def gltf(binary_uri=None, sides=SIDES):
    """The document of a glTF file of the pyramid, moved and mirrored, and its binary data."""
    positions = PYRAMID.astype("<f4").tobytes()
    indices = sides.astype("<u2").tobytes()
    data = positions + indices
    uri = binary_uri or "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    low, high = PYRAMID.min(axis=0).tolist(), PYRAMID.max(axis=0).tolist()
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"translation": [0, 0, 2], "children": [1]}, {"mesh": 0, "scale": [2, 2, -2]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.0, 0.0, 1.0, 1.0]}}],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": 5126,
                "count": 4,
                "type": "VEC3",
                "min": low,
                "max": high,
            },
            {"bufferView": 1, "componentType": 5123, "count": sides.size, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(positions)},
            {"buffer": 0, "byteOffset": len(positions), "byteLength": len(indices)},
        ],
        "buffers": [{"byteLength": len(data), "uri": uri}],
    }
    return document, data
