"""The shader of docs/formats.md on exported trees: limbs stay on what bears them, and leaves on their twigs.

    target/clients/venv/bin/python tests/clients/swing.py DIRECTORY

The formula is the document's: its GLSL is read as Python, line by line.
"""

import json
import re
import struct
import sys
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

DOCUMENT = Path(__file__).parents[2] / "docs/formats.md"
LEAN_M = 0.3
# A base and the wood beside it are a vertex each, this far apart at most.
BESIDE_M = 0.1
GAP_M = 0.01


def part(vectors, names):
    return vectors[:, ["xyz".index(name) for name in names]]


def vec3(*parts):
    return np.concatenate(np.broadcast_arrays(*[np.atleast_2d(part) for part in parts]), axis=1)


def length(vectors):
    return np.linalg.norm(vectors, axis=1, keepdims=True)


def dot(a, b):
    return (a * b).sum(axis=1, keepdims=True)


def formula():
    """The functions of the document's shader."""
    blocks = re.findall(r"```glsl\n(.*?)```", DOCUMENT.read_text(), re.S)
    (shader,) = [block for block in blocks if "vec3 swing(" in block]
    lines = []
    for line in shader.splitlines():
        line = line.split("//")[0].rstrip().removesuffix(";")
        head = re.fullmatch(r"vec3 (\w+)\((.*)\) \{", line)
        if head:
            line = f"def {head[1]}({', '.join(word.split()[-1] for word in head[2].split(','))}):"
        line = re.sub(r"^(\s+)(?:vec3|vec2|float) (?=\w+ = )", r"\1", line)
        line = re.sub(r"\b([a-z]\w*)\.(x?y?z?)\b", r'part(\1, "\2")', line)
        if line.strip("}"):
            lines.append(line)
    known = {"part": part, "vec3": vec3, "length": length, "dot": dot, "sin": np.sin, "max": np.maximum, "min": np.minimum}
    exec("\n".join(lines), known)
    return known["swing"]


def attributes(path):
    """Place, pivot, level, phase and flutter of all vertices, from attributes or packed."""
    data = path.read_bytes()
    size = struct.unpack_from("<I", data, 12)[0]
    document, binary = json.loads(data[20 : 20 + size]), data[28 + size :]

    def values(index):
        accessor = document["accessors"][index]
        view = document["bufferViews"][accessor["bufferView"]]
        kind = {5126: "<f4", 5123: "<u2", 5121: "u1"}[accessor["componentType"]]
        width = {"VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        read = np.frombuffer(binary, kind, accessor["count"] * width, start).reshape(-1, width)
        return read / np.iinfo(read.dtype).max if accessor.get("normalized") else read.astype(float)

    found = []
    for mesh in document["meshes"]:
        for primitive in mesh["primitives"]:
            of = {name: values(index) for name, index in primitive["attributes"].items()}
            if "_WIND" in of:
                pivot, (level, phase, _, flutter) = of["_WINDPIVOT"][:, :3], of["_WIND"].T
            else:
                *corner, side = mesh["extras"]["linden_wind_cube"]
                flat, high = of["TEXCOORD_1"], of["TEXCOORD_2"]
                pivot = np.array(corner) + side * np.stack([flat[:, 0], high[:, 0], flat[:, 1]], axis=1)
                level, (phase, _, flutter) = np.round(16 * high[:, 1]), of["COLOR_0"][:, :3].T
            found.append([of["POSITION"], pivot, level[:, None], phase[:, None], flutter[:, None]])
            # Leaves flutter; wood does not.
            found[-1].append(np.full((len(pivot), 1), flutter.any()))
    return [np.concatenate(column) for column in zip(*found)]


def check(path, swing):
    columns = attributes(path)
    # Feet of leaves are between their corners: a place of each by itself.
    (feet,) = columns[5].T.nonzero()[1:]
    feet = feet[np.unique(columns[1][feet], axis=0, return_index=True)[1]]
    foot_of_leaf = [column[feet] for column in columns]
    foot_of_leaf[0], foot_of_leaf[4] = foot_of_leaf[1], 0 * foot_of_leaf[4]
    place, pivot, level, phase, flutter, leaf = [np.concatenate(both) for both in zip(columns, foot_of_leaf)]
    level, leaf, arm = level[:, 0], leaf[:, 0], length(place - pivot)[:, 0]
    tree = np.array([[place[:, 1].max(), length(part(place, "xz")).max()]])
    lean = np.array([[LEAN_M, 0, 0]])
    # What bears what: the bases of limbs and twigs on wood of lower levels, feet of leaves on any wood.
    pairs = {}
    for name, borne, bearers in [
        *((f"level {n}", ~leaf & (level == n) & (arm < 0.3), ~leaf & (level < n)) for n in range(1, 6)),
        ("leaves", leaf & (arm == 0), ~leaf),
    ]:
        borne, bearers = np.flatnonzero(borne), np.flatnonzero(bearers)
        far, nearest = cKDTree(place[bearers]).query(place[borne]) if len(borne) else (np.zeros(0), np.zeros(0, int))
        pairs[name] = borne[far < BESIDE_M], bearers[nearest[far < BESIDE_M]]
    assert len(pairs["level 1"][0]) > 10 and len(pairs["leaves"][0]) > 0, "nothing is borne"
    gaps, most, foot = dict.fromkeys(pairs, 0), 0, 0
    for time in np.arange(0, 10, 0.1):
        moved = swing(place, pivot, phase, flutter, tree, lean, 0.3, time) - place
        assert np.isfinite(moved).all(), "a place is no number"
        most = max(most, length(moved).max())
        foot = max(foot, length(moved[place[:, 1] < 0.02]).max(initial=0))
        for name, (borne, bearers) in pairs.items():
            gaps[name] = max(gaps[name], length(moved[borne] - moved[bearers]).max(initial=0))
    worst = max(gaps, key=gaps.get)
    print(f"{path.name}: moves {most:.3f} m, gap {gaps[worst]:.4f} m ({worst})")
    assert gaps[worst] <= GAP_M, f"{worst} leaves what bears it by {gaps[worst]:.3f} m"
    assert 0.8 * LEAN_M < most < 2 * LEAN_M, f"the most that moves is {most:.3f} m"
    assert foot < 0.001, f"the foot moves {foot:.4f} m"


if __name__ == "__main__":
    for file in sorted(Path(sys.argv[1]).glob("*.glb")):
        try:
            check(file, formula())
        except AssertionError as error:
            sys.exit(f"{file.name}: {error}")
