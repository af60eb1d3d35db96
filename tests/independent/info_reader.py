#!/usr/bin/env python3
"""What `veduta info --json --list` must say about a CityJSON or CityJSONSeq file, read with Python's json alone.

Nothing here shares code with Veduta; the facts that depend on triangulation are left out.

    info_reader.py FILE...                  prints the facts of each file as JSON
    info_reader.py --compare VEDUTA FILE... runs `VEDUTA info --json --list` and names every difference; exit code 1 if any
"""

import collections
import json
import re
import subprocess
import sys

RING_DEPTH = {"MultiSurface": 2, "CompositeSurface": 2, "Solid": 3, "MultiSolid": 4, "CompositeSolid": 4}
DATE = re.compile(r"\d{4}-\d\d-\d\d(T\d\d:\d\d(:\d\d(\.\d+)?)?(Z|[+-]\d\d:?\d\d)?)?$")


def canonical_lod(lod):
    major, _, minor = str(lod).partition(".")
    minor = minor.rstrip("0")
    return f"{major}.{minor}" if minor else major


def canonical_crs(raw):
    codes = re.findall(r"EPSG(?::|/)[^:/,&]*(?::|/)(\d+)", raw or "") or re.findall(r"EPSG:(\d+)", raw or "")
    return "EPSG:" + "+".join(codes) if codes else None


def flat(boundaries):
    """All indices, whatever the depth."""
    open_lists = [boundaries]
    while open_lists:
        item = open_lists.pop()
        if isinstance(item, list):
            open_lists.extend(item)
        else:
            yield item


def polygons(geometry):
    level = [geometry["boundaries"]]
    for _ in range(RING_DEPTH.get(geometry["type"], 0) - 2):
        level = [inner for item in level for inner in item]
    return sum(len(item) for item in level) if geometry["type"] in RING_DEPTH else 0


def documents(path):
    with open(path, encoding="utf-8-sig") as file:
        text = file.read()
    try:
        return "CityJSON" if not path.endswith(".jsonl") else "CityJSONSeq", [json.loads(text)]
    except json.JSONDecodeError:
        return "CityJSONSeq", [json.loads(line) for line in text.splitlines() if line.strip()]


def kind_of(values):
    """The type of an attribute from all its non-null values."""
    kinds = set()
    for value in values:
        if isinstance(value, bool):
            kinds.add("boolean")
        elif isinstance(value, int):
            kinds.add("integer")
        elif isinstance(value, float):
            kinds.add("number")
        elif isinstance(value, str):
            kinds.add("date" if DATE.match(value) else "string")
        else:
            kinds.add("array" if isinstance(value, list) else "object")
    if kinds == {"integer", "number"}:
        return "number"
    if kinds == {"date", "string"}:
        return "string"
    return kinds.pop() if len(kinds) == 1 else "mixed" if kinds else None


def facts(path):
    form, docs = documents(path)
    header = docs[0]
    listed, lods = [], collections.defaultdict(lambda: {"objects": 0, "polygons": 0})
    values = collections.defaultdict(list)
    low, high = [float("inf")] * 3, [float("-inf")] * 3
    transform = header.get("transform", {"scale": [1, 1, 1], "translate": [0, 0, 0]})
    templates = header.get("geometry-templates", {})
    has_templates = False
    for doc in docs:
        vertices = doc.get("vertices", [])
        for name, thing in doc["CityObjects"].items():
            own = collections.Counter()
            for geometry in thing.get("geometry", []):
                used = geometry
                if geometry["type"] == "GeometryInstance":
                    used, has_templates = templates["templates"][geometry["template"]], True
                else:
                    for index in set(flat(geometry["boundaries"])):
                        for axis in range(3):
                            at = vertices[index][axis] * transform["scale"][axis] + transform["translate"][axis]
                            low[axis], high[axis] = min(low[axis], at), max(high[axis], at)
                own[canonical_lod(used["lod"])] += polygons(used)
            for lod, count in own.items():
                lods[lod]["objects"] += 1
                lods[lod]["polygons"] += count
            for key, value in thing.get("attributes", {}).items():
                values[key].append(value)
            listed.append({"id": name, "type": thing["type"], "parents": thing.get("parents", []), "lods": sorted(own, key=float)})
    appearance = header.get("appearance", {})
    raw = header.get("metadata", {}).get("referenceSystem")
    return {
        "format": form,
        "version": header["version"],
        "crs": canonical_crs(raw),
        "crs_raw": raw,
        "extent": None if has_templates or low[0] > high[0] else {"min": low, "max": high},
        "objects": {
            "total": len(listed),
            "by_type": dict(collections.Counter(thing["type"] for thing in listed)),
            "list": listed,
        },
        "lods": dict(lods),
        "attributes": {name: attribute(every) for name, every in values.items()},
        "textures_declared": len(appearance.get("textures", [])),
    }


def key_of(value):
    """Values that are equal as numbers are one value: 1 and 1.0."""
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return json.dumps(float(value) if is_number else value, sort_keys=True)


def attribute(every):
    present = [value for value in every if value is not None]
    kind = kind_of(present)
    ordered = kind in ("integer", "number", "date")
    counts = collections.Counter(key_of(value) for value in present)
    return {
        "count": len(present),
        "nulls": len(every) - len(present),
        "type": kind,
        "min": min(present) if ordered else None,
        "max": max(present) if ordered else None,
        "distinct": len(counts),
        "counts": dict(counts),
    }


def compare(path, veduta):
    expected = facts(path)
    found = json.loads(subprocess.run([veduta, "info", "--json", "--list", path], check=True, capture_output=True).stdout)
    differences = []

    def check(place, wanted, got):
        if wanted != got:
            differences.append(f"{place}: expected {json.dumps(wanted)[:200]}, found {json.dumps(got)[:200]}")

    for key in ("format", "version", "crs", "crs_raw"):
        check(key, expected[key], found[key])
    if expected["extent"]:
        for end in ("min", "max"):
            off = max(abs(a - b) for a, b in zip(expected["extent"][end], found["extent"][end]))
            if off > 1e-6:
                differences.append(f"extent.{end}: expected {expected['extent'][end]}, found {found['extent'][end]}")
    for key in ("total", "by_type"):
        check(f"objects.{key}", expected["objects"][key], found["objects"][key])
    for wanted, got in zip(expected["objects"]["list"], found["objects"]["list"]):
        check(f"object {wanted['id']}", wanted, {key: got[key] for key in wanted})
    check("lods", expected["lods"], {lod: {k: v[k] for k in ("objects", "polygons")} for lod, v in found["lods"].items()})
    check("textures.declared", expected["textures_declared"], found["textures"]["declared"])
    check("attribute names", sorted(expected["attributes"]), sorted(found["attributes"]))
    for name, wanted in expected["attributes"].items():
        got = found["attributes"].get(name, {})
        for key in ("count", "nulls", "type", "min", "max"):
            check(f"attribute {name}.{key}", wanted[key], got.get(key))
        values = got.get("values", [])
        check(f"attribute {name}: number of values", min(64, wanted["distinct"]), len(values))
        top = sorted(wanted["counts"].values(), reverse=True)[:64]
        check(f"attribute {name}: counts", top, [count for _, count in values])
        for value, count in values:
            check(f"attribute {name}: count of {value}", wanted["counts"].get(key_of(value)), count)
    return differences


def main(arguments):
    if arguments[:1] != ["--compare"]:
        for path in arguments:
            print(json.dumps(facts(path), indent=1, ensure_ascii=False))
        return 0
    veduta, paths, failed = arguments[1], arguments[2:], False
    for path in paths:
        differences = compare(path, veduta)
        failed |= bool(differences)
        print(f"{path}: {'agrees' if not differences else ''}")
        for line in differences[:20]:
            print("  " + line)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
