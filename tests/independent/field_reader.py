#!/usr/bin/env python3
"""What the shared volumes hold, read with Python's standard library alone.

Nothing here shares code with Veduta.

    field_reader.py FILE...   prints one line of JSON for each file: its arrays in the order of the file, each with name, size,
                              origin, steps, components, times, and for the first and the last time: least, greatest and summed
                              finite value, the same weighted by place, how many are missing, and 20 values at fixed
                              places (null where missing)
"""

import base64
import json
import math
import os
import re
import struct
import sys
import urllib.parse
import xml.etree.ElementTree as ElementTree
import zlib


def single(value):
    """The nearest number of 32 bits."""
    return struct.unpack("<f", struct.pack("<f", value))[0]


def unit_normal(a, b):
    n = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    length = math.sqrt(sum(c * c for c in n))
    return [c / length for c in n]


def facts(values):
    """Of all numbers of one time: components innermost, then x, y, z."""
    if isinstance(values, (bytes, bytearray)):
        least, greatest, total, missing = min(values), max(values), sum(values), 0
    else:
        finite = [v for v in values if math.isfinite(v)]
        least, greatest, total, missing = min(finite), max(finite), math.fsum(finite), len(values) - len(finite)
    # Of every 251st number, as often as its place says: values in a wrong order give another sum.
    known = values if missing == 0 else [v if math.isfinite(v) else 0 for v in values]
    weighted = math.fsum(k * math.fsum(known[k::251]) for k in range(251))
    places = [(i * 104729 + 17) % len(values) for i in range(20)]
    some = [values[p] if math.isfinite(values[p]) else None for p in places]
    return {"min": least, "max": greatest, "sum": total, "missing": missing, "weighted": weighted, "count": len(values), "values": some}


def array(name, size, origin, steps, components, times):
    chosen = [times[0], times[-1]]
    return {"name": name, "size": size, "origin": origin, "steps": steps, "components": components,
            "times": len(times), "facts": [facts(values) for values in chosen]}


def flipped(values, size, components):
    """From the last axis fastest to the first axis fastest."""
    nx, ny, nz = size
    out = []
    for z in range(nz):
        for y in range(ny):
            for x in range(nx):
                at = ((x * ny + y) * nz + z) * components
                out.extend(values[at:at + components])
    return out


def read_dx(path):
    """Native files with all numbers behind `end`, most significant byte first."""
    data = open(path, "rb").read()
    end = data.index(b"\nend\n") + 5
    header = data[:end].decode()
    objects = dict(re.findall(r'^object ("[^"]+"|\d+) class (.*?)(?=^object|^end)', header, re.M | re.S))

    def numbers(text):
        components = int((re.search(r"shape (\d+)", text) or [0, "1"])[1])
        items = int(re.search(r"items (\d+)", text)[1])
        offset = end + int(re.search(r"data (\d+)", text)[1])
        count = items * components
        return components, list(struct.unpack(">%df" % count, data[offset:offset + 4 * count]))

    (key, field), = [(k, v) for k, v in objects.items() if v.startswith("field")]
    parts = dict(re.findall(r'component "(\w+)" value (\d+)', field))
    counts = [int(n) for n in re.search(r"counts ([\d ]+)", objects[parts["connections"]])[1].split()]
    components, values = numbers(objects[parts["data"]])
    size = (counts + [1, 1])[:3]
    positions = objects[parts["positions"]]
    if positions.startswith("gridpositions"):
        origin = [float(n) for n in re.search(r"origin (.*)", positions)[1].split()]
        steps = [[float(n) for n in line.split()] for line in re.findall(r"delta (.*)", positions)]
    else:
        dimension, places = numbers(positions)
        assert dimension == 2
        place = lambda x, y: [places[2 * (x * size[1] + y)], places[2 * (x * size[1] + y) + 1], 0.0]
        origin = place(0, 0)
        to = lambda p, n: [(b - a) / n for a, b in zip(origin, p)]
        steps = [to(place(size[0] - 1, 0), size[0] - 1), to(place(0, size[1] - 1), size[1] - 1)]
        for x in range(size[0]):
            for y in range(size[1]):
                wanted = [o + x * a + y * b for o, a, b in zip(origin, *steps)]
                assert math.dist(wanted, place(x, y)) < 1e-3, "the places are not regular"
        steps.append(unit_normal(*steps))
    name = re.search(r'attribute "name" string "([^"]+)"', field)
    name = name[1] if name else key.strip('"')
    stem = os.path.basename(path).rsplit(".", 1)[0]
    name = stem if name == "default" else name
    return [array(name, size, origin, steps, components, [flipped(values, size, components)])]


def general(path):
    text = re.sub(r"^#.*$", "", open(path).read(), flags=re.M)
    header = {k.strip(): v.strip() for k, v in re.findall(r"^([^=\n]+)=(.*)$", text, re.M)}
    lines = open(os.path.join(os.path.dirname(path), header["file"])).read().splitlines()
    return header, lines[int(header["header"].split()[1]):]


def read_co2(path):
    header, lines = general(path)
    points, series = int(header["points"]), int(header["series"])
    rows = [[single(float(word)) for word in line[25:].split()] for line in lines[:points * series]]
    assert all(len(row) == 3 for row in rows)
    places = [row[:2] for row in rows[:points]]
    for step in range(series):
        assert [row[:2] for row in rows[step * points:(step + 1) * points]] == places, "stations move"
    low = [min(p[axis] for p in places) for axis in (0, 1)]
    extent = [max(p[axis] for p in places) - low[axis] for axis in (0, 1)]
    size = [max(32, min(128, math.floor(e / max(extent) * 128 + 0.5))) for e in extent]
    step = [e / (n - 1) for e, n in zip(extent, size)]
    samples = [(low[0] + x * step[0], low[1] + y * step[1]) for y in range(size[1]) for x in range(size[0])]
    squared = [[(sx - px) ** 2 + (sy - py) ** 2 for px, py in places] for sx, sy in samples]
    times = []
    for t in range(series):
        known = [(i, row[2]) for i, row in enumerate(rows[t * points:(t + 1) * points]) if row[2] != -100.0]
        out = []
        for distances in squared:
            exact = [v for i, v in known if distances[i] == 0.0]
            if exact:
                out.append(exact[0])
                continue
            weights = [1.0 / distances[i] for i, _ in known]
            out.append(single(sum(w * v for w, (_, v) in zip(weights, known)) / sum(weights)))
        times.append(out)
    steps = [[step[0], 0.0, 0.0], [0.0, step[1], 0.0], [0.0, 0.0, 1.0]]
    return [array("co2_conc", size + [1], low + [0.0], steps, 1, times)]


def read_wind(path):
    header, lines = general(path)
    nx, ny = [int(n) for n in header["grid"].split("x")]
    ox, dx, oy, dy = [float(n) for n in header["positions"].split(",")]
    rows = [[single(float(word)) for word in line[39:].split()] for line in lines[:nx * ny]]
    assert all(len(row) == 3 for row in rows)
    hidden = lambda v: math.nan if v == -1e9 else v
    wind = [hidden(v) for row in rows for v in row[1:]]
    steps = [[dx, 0.0, 0.0], [0.0, dy, 0.0], [0.0, 0.0, 1.0]]
    place = ([nx, ny, 1], [ox, oy, 0.0], steps)
    return [array("temperature", *place, 1, [[row[0] for row in rows]]), array("wind_velocity", *place, 2, [wind])]


def read_vti(path):
    image = ElementTree.parse(path).getroot().find("ImageData")
    extent = [int(n) for n in image.get("WholeExtent").split()]
    size = [extent[2 * i + 1] - extent[2 * i] + 1 for i in range(3)]
    spacing = [float(n) for n in image.get("Spacing").split()]
    element, = image.findall("Piece/PointData/DataArray")
    text = "".join(element.text.split())
    # The lengths are one piece of base64, the blocks another.
    blocks, = struct.unpack("<I", base64.b64decode(text[:8])[:4])
    digits = (4 * (3 + blocks) + 2) // 3 * 4
    lengths = struct.unpack("<%dI" % (3 + blocks), base64.b64decode(text[:digits])[:4 * (3 + blocks)])[3:]
    packed, values, at = base64.b64decode(text[digits:]), bytearray(), 0
    for length in lengths:
        values += zlib.decompress(packed[at:at + length])
        at += length
    steps = [[spacing[i] if i == j else 0.0 for j in range(3)] for i in range(3)]
    return [array(element.get("Name"), size, [float(n) for n in image.get("Origin").split()], steps, 1, [bytes(values)])]


def read_vtk(path):
    data = open(path, "rb").read()
    size = [int(n) for n in re.search(rb"DIMENSIONS (.*)", data)[1].split()]
    spacing = [float(n) for n in re.search(rb"SPACING (.*)", data)[1].split()]
    origin = [float(n) for n in re.search(rb"ORIGIN (.*)", data)[1].split()]
    steps = [[spacing[i] if i == j else 0.0 for j in range(3)] for i in range(3)]
    cells = re.search(rb"(\S+) 1 (\d+) double\n", data)
    points = re.search(rb"SCALARS (\S+) double\s*\d*\nLOOKUP_TABLE default\n", data)
    out = []
    for match, count, own, start in [
        (cells, int(cells[2]), [n - 1 for n in size], [o + s / 2 for o, s in zip(origin, spacing)]),
        (points, math.prod(size), size, origin),
    ]:
        values = struct.unpack(">%dd" % count, data[match.end():match.end() + 8 * count])
        name = urllib.parse.unquote(match[1].decode())
        out.append(array(name, own, start, steps, 1, [[single(v) for v in values]]))
    return out


def main():
    readers = {"CO2.general": read_co2, "temp_wind.general": read_wind}
    by_extension = {"dx": read_dx, "vti": read_vti, "vtk": read_vtk}
    for path in sys.argv[1:]:
        name = os.path.basename(path)
        read = readers.get(name) or by_extension[name.rsplit(".", 1)[1]]
        print(json.dumps(read(path)))


if __name__ == "__main__":
    main()
