"""Reads exported files as arrays, with nothing repaired on the way.

Libraries drop what is broken and guess what is missing, so a check behind them is blind; these
readers are as plain as the formats allow, and fail on anything they do not expect.
"""

import base64
import json
import struct
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote

import numpy as np


@dataclass
class Mesh:
    name: str
    positions: np.ndarray
    normals: np.ndarray
    uvs: np.ndarray  # V up
    triangles: np.ndarray
    bounds: tuple | None = None  # as the file declares them


@dataclass
class Tree:
    """What is in one file."""

    meshes: list = field(default_factory=list)
    edges: np.ndarray | None = None  # of a skeleton
    nodes: np.ndarray | None = None
    recipe: str = ""
    files: list = field(default_factory=list)  # paths that it refers to


def read(path: Path) -> Tree:
    reader = {".obj": obj, ".ply": ply, ".gltf": gltf, ".glb": gltf, ".usda": usda}[path.suffix]
    return reader(path)


def obj(path):
    tree = Tree()
    arrays = {"v": [], "vt": [], "vn": []}
    parts = []
    for line in path.read_text(encoding="utf-8").splitlines():
        key, _, rest = line.partition(" ")
        if key in arrays:
            numbers = [float(x) for x in rest.split()]
            assert len(numbers) == (2 if key == "vt" else 3), f"'{line}' has {len(numbers)} numbers"
            arrays[key].append(numbers)
        elif key == "o":
            parts.append((rest, []))
        elif key == "f":
            corners = [tuple(int(x) - 1 for x in corner.split("/")) for corner in rest.split()]
            assert all(len(corner) == 3 and len(set(corner)) == 1 for corner in corners), line
            parts[-1][1].append([corner[0] for corner in corners])
        elif key == "#" and rest.startswith("recipe: "):
            tree.recipe = rest.removeprefix("recipe: ")
        elif key == "mtllib":
            library = path.parent / rest
            tree.files.append(library)
            for line in library.read_text(encoding="utf-8").splitlines() if library.is_file() else []:
                if line.startswith(("map_Kd ", "norm ")):
                    tree.files.append(path.parent / line.split(" ", 1)[1])
        else:
            assert key in ("g", "s", "usemtl", "l", "#", ""), f"unknown line '{line}'"
    positions, uvs, normals = (np.array(arrays[k], dtype=np.float64) for k in ("v", "vt", "vn"))
    surface = len(uvs)  # a skeleton's vertices come last and have none
    assert len(normals) == surface <= len(positions), "v, vt and vn differ in number"
    for name, faces in parts:
        if faces:
            triangles = np.array(faces)
            first, last = triangles.min(), triangles.max() + 1
            inside = slice(first, last)
            tree.meshes.append(
                Mesh(name, positions[inside], normals[inside], uvs[inside], triangles - first))
    return tree


PLY_TYPES = {"float": "<f4", "uchar": "u1", "int": "<i4"}


def ply(path):
    data = path.read_bytes()
    head, _, body = data.partition(b"end_header\n")
    tree = Tree()
    elements = []
    for line in head.decode("ascii", "replace").splitlines():
        words = line.split()
        if line.startswith("comment recipe: "):
            tree.recipe += line.removeprefix("comment recipe: ")
        elif words[0] == "format":
            ascii_ = words[1] == "ascii"
            assert ascii_ or words[1] == "binary_little_endian"
        elif words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property":
            if words[1] == "list":  # of triangles only: a count and three numbers
                elements[-1][2].extend([("count", PLY_TYPES[words[2]]), (words[4], PLY_TYPES[words[3]], 3)])
            else:
                elements[-1][2].append((words[2], PLY_TYPES[words[1]]))
    found = {}
    lines = iter(body.decode("ascii").splitlines()) if ascii_ else None
    for name, count, fields in elements:
        dtype = np.dtype(fields)
        if ascii_:
            width = sum(3 if len(f) == 3 else 1 for f in fields)
            rows = np.array([next(lines).split() for _ in range(count)], dtype=np.float64)
            assert rows.shape == (count, width), f"{name}: rows of {rows.shape}"
            table, column = np.zeros(count, dtype), 0
            for f in fields:
                n = 3 if len(f) == 3 else 1
                table[f[0]] = rows[:, column:column + n] if n == 3 else rows[:, column]
                column += n
        else:
            table = np.frombuffer(body, dtype, count)
            body = body[count * dtype.itemsize:]
        found[name] = table
    assert (next(lines, None) is None) if ascii_ else not body, "bytes after the last element"
    vertex = found["vertex"]
    stack = lambda *names: np.stack([vertex[n] for n in names], axis=1).astype(np.float64)
    if "edge" in found:
        tree.nodes = stack("x", "y", "z", "radius")
        tree.edges = np.stack([found["edge"]["vertex1"], found["edge"]["vertex2"]], axis=1)
    else:
        assert (found["face"]["count"] == 3).all(), "a face is no triangle"
        tree.meshes = [Mesh("all", stack("x", "y", "z"), stack("nx", "ny", "nz"), stack("s", "t"),
                            found["face"]["vertex_indices"].astype(np.int64))]
    return tree


def gltf(path):
    tree = Tree()
    data = path.read_bytes()
    binary = None
    if path.suffix == ".glb":
        magic, version, length, json_length = struct.unpack_from("<4sIII", data)
        assert (magic, version, length) == (b"glTF", 2, len(data)), "the GLB header disagrees"
        document = json.loads(data[20:20 + json_length])
        at = 20 + json_length
        binary_length, kind = struct.unpack_from("<I4s", data, at)
        assert kind == b"BIN\0" and at + 8 + binary_length == length
        binary = data[at + 8:]
    else:
        document = json.loads(data)
        uri = document["buffers"][0]["uri"]
        if uri.startswith("data:"):
            binary = base64.b64decode(uri.split(",", 1)[1], validate=True)
        else:
            tree.files.append(path.parent / unquote(uri))
            binary = tree.files[-1].read_bytes()
    for image in document.get("images", []):
        if "uri" in image:
            tree.files.append(path.parent / unquote(image["uri"]))
    assert document["buffers"][0]["byteLength"] == len(binary), "byteLength disagrees with the buffer"

    def array(index):
        accessor = document["accessors"][index]
        view = document["bufferViews"][accessor["bufferView"]]
        dtype = {5123: "<u2", 5125: "<u4", 5126: "<f4"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        raw = binary[view["byteOffset"]:view["byteOffset"] + view["byteLength"]]
        return np.frombuffer(raw, dtype)[:accessor["count"] * width].reshape(-1, width)

    for mesh in document["meshes"]:
        (primitive,) = mesh["primitives"]
        attributes = primitive["attributes"]
        position = document["accessors"][attributes["POSITION"]]
        if "TANGENT" in attributes:
            tangents, normals = array(attributes["TANGENT"]), array(attributes["NORMAL"])
            assert len(tangents) == len(normals), "TANGENT has another length"
            assert (np.abs(tangents[:, 3]) == 1).all(), "a tangent has no side"
            assert np.abs((tangents[:, :3] * normals).sum(axis=1)).max() < 1e-4, "a tangent leaves the surface"
        uvs = array(attributes["TEXCOORD_0"]).astype(np.float64)
        tree.meshes.append(Mesh(
            mesh["name"], array(attributes["POSITION"]).astype(np.float64),
            array(attributes["NORMAL"]).astype(np.float64), np.stack([uvs[:, 0], 1 - uvs[:, 1]], axis=1),
            array(primitive["indices"]).astype(np.int64).reshape(-1, 3), (position["min"], position["max"])))
    root = document["nodes"][document["scenes"][0]["nodes"][0]]
    tree.recipe = json.dumps(root.get("extras", {}).get("linden", ""))
    return tree


def usda(path):
    from pxr import Usd, UsdGeom, UsdShade

    stage = Usd.Stage.Open(str(path))
    assert stage, "usd-core cannot open it"
    root = stage.GetDefaultPrim()
    assert root, "no defaultPrim"
    assert UsdGeom.GetStageUpAxis(stage) == "Y" and UsdGeom.GetStageMetersPerUnit(stage) == 1
    tree = Tree()
    tree.recipe = root.GetAttribute("userProperties:linden:recipe").Get() or ""
    assert root.GetCustomDataByKey("linden:recipe") == tree.recipe, "customData has another recipe"
    for prim in stage.Traverse():
        if prim.IsA(UsdGeom.Mesh):
            mesh = UsdGeom.Mesh(prim)
            counts = np.array(mesh.GetFaceVertexCountsAttr().Get())
            assert (counts == 3).all(), "a face is no triangle"
            numbers = lambda attribute: np.array(attribute.Get(), dtype=np.float64)
            st = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
            assert mesh.GetNormalsInterpolation() == st.GetInterpolation() == "vertex"
            indices = np.array(st.GetIndices() or [0])
            assert 0 <= indices.min() and indices.max() < len(st.Get()), "an index of st names no value"
            triangles = np.array(mesh.GetFaceVertexIndicesAttr().Get()).astype(np.int64)
            assert len(triangles) == 3 * len(counts), "faceVertexCounts and faceVertexIndices disagree"
            tree.meshes.append(Mesh(
                prim.GetName(), numbers(mesh.GetPointsAttr()), numbers(mesh.GetNormalsAttr()),
                np.array(st.ComputeFlattened(), dtype=np.float64),
                triangles.reshape(-1, 3), tuple(np.array(p) for p in mesh.GetExtentAttr().Get())))
            assert UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0], "no material is bound"
        elif prim.IsA(UsdGeom.BasisCurves):
            curves = UsdGeom.BasisCurves(prim)
            counts = np.array(curves.GetCurveVertexCountsAttr().Get())
            points = np.array(curves.GetPointsAttr().Get(), dtype=np.float64)
            widths = np.array(curves.GetWidthsAttr().Get(), dtype=np.float64)
            assert counts.min() >= 2 and counts.sum() == len(points) == len(widths), "curve arrays disagree"
            assert curves.GetPurposeAttr().Get() == "guide"
            for name in ("linden:order", "linden:birth"):
                primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar(name)
                expected = {"uniform": len(counts), "vertex": len(points)}[primvar.GetInterpolation()]
                assert len(primvar.Get()) == expected, f"{name} has another length"
            tree.nodes = np.column_stack([points, widths / 2])
            firsts = np.cumsum(counts) - counts
            tree.edges = np.array([[first + i, first + i + 1] for first, count in zip(firsts, counts)
                                   for i in range(count - 1)])
        elif prim.IsA(UsdShade.Shader):
            file = prim.GetAttribute("inputs:file")
            if file and file.Get():
                assert file.Get().path.startswith("./"), f"{file.Get()} is not anchored"
                tree.files.append(path.parent / file.Get().path)
    return tree
