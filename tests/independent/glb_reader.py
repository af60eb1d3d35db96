#!/usr/bin/env python3
"""What a GLB or glTF file holds, read without Veduta: struct and json only, fractions for exactness.

    python3 tests/independent/glb_reader.py FILE...

One line of JSON per file: mesh nodes depth first (id, parents), triangles as written, triangles that have an area,
triangles without repeats, extent of all corners, z up. Triangles lists only (no strips, no sparse accessors), buffers
of the file itself or beside it. `tests/data/meshes.rs` pins what it prints for the shared file.
"""
import base64
import json
import os
import struct
import sys
from fractions import Fraction

COMPONENTS = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
DIMENSIONS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


def open_file(path):
    with open(path, "rb") as file:
        data = file.read()
    if data[:4] != b"glTF":
        return json.loads(data), None
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20:20 + length])
    start = 20 + length
    return document, data[start + 8:start + 8 + struct.unpack_from("<I", data, start)[0]]


def buffer(document, index, chunk, path):
    uri = document["buffers"][index].get("uri")
    if uri is None:
        return chunk
    if uri.startswith("data:"):
        return base64.b64decode(uri.split(",", 1)[1])
    with open(os.path.join(os.path.dirname(path), uri.replace("%20", " ")), "rb") as file:
        return file.read()


def accessor(document, index, chunk, path):
    a = document["accessors"][index]
    view = document["bufferViews"][a["bufferView"]]
    data = buffer(document, view["buffer"], chunk, path)
    code = "<%d%s" % (DIMENSIONS[a["type"]], COMPONENTS[a["componentType"]])
    stride = view.get("byteStride", struct.calcsize(code))
    start = view.get("byteOffset", 0) + a.get("byteOffset", 0)
    return [struct.unpack_from(code, data, start + i * stride) for i in range(a["count"])]


def matrix(node):
    """Rows of the node's transform."""
    if "matrix" in node:
        m = node["matrix"]
        return [[Fraction(m[4 * c + r]) for c in range(4)] for r in range(3)]
    x, y, z, w = (Fraction(q) for q in node.get("rotation", (0, 0, 0, 1)))
    s = [Fraction(v) for v in node.get("scale", (1, 1, 1))]
    t = [Fraction(v) for v in node.get("translation", (0, 0, 0))]
    r = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
         [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
         [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    return [[r[i][j] * s[j] for j in range(3)] + [t[i]] for i in range(3)]


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) + (a[i][3] if j == 3 else 0) for j in range(4)] for i in range(3)]


def cross(a, b, c):
    u = [b[i] - a[i] for i in range(3)]
    v = [c[i] - a[i] for i in range(3)]
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def read(path):
    document, chunk = open_file(path)
    objects, corners, written, sound, distinct = [], [], 0, 0, 0

    def visit(index, above, parent):
        nonlocal written, sound, distinct
        node = document["nodes"][index]
        here = product(above, matrix(node))
        if "mesh" in node:
            name = node.get("name") or "node-%d" % index
            objects.append({"id": name, "parents": [parent] if parent else []})
            parent = name
            seen = set()
            for primitive in document["meshes"][node["mesh"]]["primitives"]:
                assert primitive.get("mode", 4) == 4, "triangle lists only"
                local = accessor(document, primitive["attributes"]["POSITION"], chunk, path)
                points = [tuple(sum(row[k] * Fraction(p[k]) for k in range(3)) + row[3] for row in here) for p in local]
                indices = primitive.get("indices")
                order = range(len(points)) if indices is None else [i[0] for i in accessor(document, indices, chunk, path)]
                order = list(order)
                for t in range(0, len(order) - 2, 3):
                    triangle = [points[i] for i in order[t:t + 3]]
                    written += 1
                    corners.extend(triangle)
                    if any(cross(*triangle)):
                        sound += 1
                        first = triangle.index(min(triangle))
                        key = tuple(triangle[first:] + triangle[:first])
                        distinct += key not in seen
                        seen.add(key)
        for child in node.get("children", []):
            visit(child, here, parent)

    up = [[Fraction(v) for v in row] for row in ((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0))]
    for root in document["scenes"][document.get("scene", 0)]["nodes"]:
        visit(root, up, None)
    return {
        "objects": objects,
        "triangles": written,
        "with_area": sound,
        "distinct": distinct,
        "min": [float(min(c[i] for c in corners)) for i in range(3)],
        "max": [float(max(c[i] for c in corners)) for i in range(3)],
    }


for name in sys.argv[1:]:
    print(json.dumps({"file": os.path.basename(name), **read(name)}))
