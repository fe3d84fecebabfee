"""Reads exported files as arrays, with nothing repaired on the way.

Libraries drop what is broken and guess what is missing, so a check behind them is blind; these
readers are as plain as the formats allow, and fail on anything they do not expect.
"""

import base64
import json
import shutil
import struct
import subprocess
import sys
import tempfile
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
    second: np.ndarray | None = None  # TEXCOORD_1, as it is stored


@dataclass
class Tree:
    """What is in one file."""

    meshes: list = field(default_factory=list)
    edges: np.ndarray | None = None  # of a skeleton
    nodes: np.ndarray | None = None
    recipe: str = ""
    files: list = field(default_factory=list)  # paths that it refers to
    around: list = field(default_factory=list)  # meshes of the setting: ground and sky
    collider_triangles: int = 0  # of meshes that are for physics
    is_rounded: bool = False  # whether it stores turns or vertices in 16 bits or less
    is_instanced: bool = False  # whether it needs a reader that knows instances
    is_compressed: bool = False  # whether it needs one that decompresses
    is_bare: bool = False  # whether its format holds triangles alone: no recipe, no texture coordinates


def read(path: Path) -> Tree:
    reader = {".obj": obj, ".ply": ply, ".gltf": gltf, ".glb": gltf, ".usda": usda, ".usdc": usda, ".usdz": usda, ".stl": stl}[path.suffix]
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


STL_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])


def stl(path):
    data = path.read_bytes()
    assert not data.startswith(b"solid"), "it looks like text"
    (count,) = struct.unpack_from("<I", data, 80)
    assert len(data) == 84 + 50 * count, f"{len(data)} bytes for {count} triangles"
    table = np.frombuffer(data, STL_TRIANGLE, count, 84)
    assert not table["attributes"].any(), "a triangle has attributes"

    def y_up(vectors):
        x, y, z = vectors.astype(np.float64).T
        return np.stack([x, z, -y], axis=1)

    tree = Tree(is_bare=True)
    corners = y_up(table["corners"].reshape(-1, 3))
    normals = y_up(np.repeat(table["normal"], 3, axis=0))
    triangles = np.arange(3 * count).reshape(-1, 3)
    tree.meshes.append(Mesh(path.stem, corners, normals, np.zeros((3 * count, 2)), triangles))
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


def container(path):
    """The JSON and the first buffer of a glTF file, and the file that the buffer is in, if it has its own."""
    data = path.read_bytes()
    if path.suffix == ".glb":
        magic, version, length, json_length = struct.unpack_from("<4sIII", data)
        assert (magic, version, length) == (b"glTF", 2, len(data)), "the GLB header disagrees"
        document = json.loads(data[20:20 + json_length])
        at = 20 + json_length
        binary_length, kind = struct.unpack_from("<I4s", data, at)
        assert kind == b"BIN\0" and at + 8 + binary_length == length
        return document, data[at + 8:], None
    document = json.loads(data)
    uri = document["buffers"][0]["uri"]
    if uri.startswith("data:"):
        return document, base64.b64decode(uri.split(",", 1)[1], validate=True), None
    file = path.parent / unquote(uri)
    return document, file.read_bytes(), file


MESHOPT = "EXT_meshopt_compression"


def views(document, binary):
    """The bytes of each buffer view; compressed ones are decoded by another program."""
    assert document["buffers"][0]["byteLength"] == len(binary), "byteLength disagrees with the buffer"
    all_views = document["bufferViews"]
    packed = [view for view in all_views if MESHOPT in view.get("extensions", {})]
    decoded = b""
    if packed:
        assert MESHOPT in document["extensionsRequired"], "there is no uncompressed copy"
        _, fallback = document["buffers"]
        assert fallback["extensions"][MESHOPT] == {"fallback": True} and "uri" not in fallback
        for view in packed:
            own = view["extensions"][MESHOPT]
            assert (view["buffer"], own["buffer"]) == (1, 0)
            assert own["byteOffset"] + own["byteLength"] <= len(binary)
            assert view["byteOffset"] + view["byteLength"] <= fallback["byteLength"]
            assert view["byteLength"] == own["count"] * own["byteStride"]
            assert view.get("byteStride", own["byteStride"]) == own["byteStride"]
        decoded = with_meshoptimizer(document, binary)
    at, found = 0, []
    for view in all_views:
        if MESHOPT in view.get("extensions", {}):
            found.append(decoded[at:at + view["byteLength"]])
            at += view["byteLength"]
        else:
            assert view["buffer"] == 0
            found.append(binary[view["byteOffset"]:view["byteOffset"] + view["byteLength"]])
        assert len(found[-1]) == view["byteLength"], "a view leaves its buffer"
    assert at == len(decoded)
    return found


def with_meshoptimizer(document, binary):
    clients = Path(sys.executable).parent.parent.parent
    # setup.sh puts one beside Python where the machine has none.
    node = shutil.which("node") or Path(sys.executable).with_name("node")
    with tempfile.TemporaryDirectory() as directory:
        [text, buffer, out] = [Path(directory) / name for name in ("a.json", "a.bin", "out.bin")]
        text.write_text(json.dumps(document))
        buffer.write_bytes(binary)
        script = Path(__file__).with_name("gltf_meshopt.mjs")
        done = subprocess.run([node, script, clients / "node_modules", text, buffer, out],
                              capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"the decoder says: {done.stderr.strip()[-500:]}"
        return out.read_bytes()


def gltf(path):
    tree = Tree()
    document, binary, beside = container(path)
    if beside:
        tree.files.append(beside)
    tree.is_compressed = MESHOPT in document.get("extensionsRequired", [])
    for image in document.get("images", []):
        if "uri" in image:
            tree.files.append(path.parent / unquote(image["uri"]))
    bytes_of = views(document, binary)

    def array(index):
        accessor = document["accessors"][index]
        view = document["bufferViews"][accessor["bufferView"]]
        dtype = np.dtype({5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
                         [accessor["componentType"]])
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        raw = bytes_of[accessor["bufferView"]]
        stride = view.get("byteStride", dtype.itemsize * width)
        rows = np.lib.stride_tricks.as_strided(
            np.frombuffer(raw, dtype), (accessor["count"], width), (stride, dtype.itemsize))
        if accessor.get("normalized"):
            tree.is_rounded = True
            return np.maximum(rows / np.iinfo(dtype).max, -1.0)
        return rows

    def texture(material):
        """Offset and scale of texture coordinates."""
        info = document["materials"][material].get("pbrMetallicRoughness", {}).get("baseColorTexture", {})
        moved = info.get("extensions", {}).get("KHR_texture_transform", {})
        return np.array(moved.get("offset", [0, 0])), np.array(moved.get("scale", [1, 1]))

    def meshes(index):
        mesh = document["meshes"][index]
        for primitive in mesh["primitives"]:
            attributes = primitive["attributes"]
            position = document["accessors"][attributes["POSITION"]]
            positions, normals = array(attributes["POSITION"]), array(attributes["NORMAL"])
            slack = 2e-2 if normals.dtype != np.float32 else 1e-4
            if "TANGENT" in attributes:
                tangents = array(attributes["TANGENT"])
                assert len(tangents) == len(normals), "TANGENT has another length"
                assert (np.abs(tangents[:, 3]) == 1).all(), "a tangent has no side"
                assert np.abs((tangents[:, :3] * normals).sum(axis=1)).max() < slack, "a tangent leaves the surface"
            offset, scale = texture(primitive["material"])
            uvs = array(attributes["TEXCOORD_0"]).astype(np.float64) * scale + offset
            bounds = (position["min"], position["max"])
            if position.get("normalized"):
                bounds = None
                # Eight bits round the length too.
                normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
            yield Mesh(mesh["name"], positions.astype(np.float64), normals.astype(np.float64),
                       np.stack([uvs[:, 0], 1 - uvs[:, 1]], axis=1),
                       array(primitive["indices"]).astype(np.int64).reshape(-1, 3), bounds,
                       array(attributes["TEXCOORD_1"]).astype(np.float64) if "TEXCOORD_1" in attributes else None)

    def local(node):
        x, y, z, w = node.get("rotation", [0, 0, 0, 1])
        turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                         [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                         [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
        matrix = np.eye(4)
        matrix[:3, :3] = turn * np.array(node.get("scale", [1, 1, 1]))
        matrix[:3, 3] = node.get("translation", [0, 0, 0])
        return matrix

    def visit(index, above):
        node = document["nodes"][index]
        matrix = above @ local(node)
        instances = node.get("extensions", {}).get("EXT_mesh_gpu_instancing")
        if instances:
            tree.is_instanced = True
            columns = [array(instances["attributes"][k]) for k in ("TRANSLATION", "ROTATION", "SCALE")]
            places = [matrix @ local(dict(translation=t, rotation=r, scale=s)) for t, r, s in zip(*columns)]
        else:
            places = [matrix]
        if "mesh" in node and (node["name"].startswith("UCX_") or node["name"].endswith("-convcolonly")):
            # For physics: neither normals nor a material.
            for primitive in document["meshes"][node["mesh"]]["primitives"]:
                assert list(primitive["attributes"]) == ["POSITION"] and "material" not in primitive
                tree.collider_triangles += len(array(primitive["indices"])) // 3
        elif "mesh" in node:
            into = tree.around if node["name"].startswith(("Ground", "Sky")) else tree.meshes
            into.extend(moved(mesh, place) for mesh in meshes(node["mesh"]) for place in places)
        for child in node.get("children", []):
            visit(child, matrix)

    for index in document["scenes"][0]["nodes"]:
        visit(index, np.eye(4))
    root = document["nodes"][document["scenes"][0]["nodes"][0]]
    tree.recipe = json.dumps(root.get("extras", {}).get("linden", ""))
    return tree


def moved(mesh, matrix):
    """A mesh where a node (a matrix of columns) puts it; its bounds are checked where they are declared."""
    if (matrix == np.eye(4)).all():
        return mesh
    if mesh.bounds is not None:
        actual = np.array([mesh.positions.min(axis=0), mesh.positions.max(axis=0)])
        assert (np.array(mesh.bounds, dtype=np.float32) == actual.astype(np.float32)).all(), "bounds differ"
    normals = mesh.normals @ matrix[:3, :3].T
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    positions = mesh.positions @ matrix[:3, :3].T + matrix[:3, 3]
    return Mesh(mesh.name, positions, normals, mesh.uvs, mesh.triangles, second=mesh.second)


def entries(path):
    """The names in a usdz; it must be as its specification wants it."""
    import zipfile

    with zipfile.ZipFile(path) as package:
        assert package.testzip() is None, "an entry's sum is wrong"
        infos = package.infolist()
        assert infos[0].filename.endswith((".usda", ".usdc")), "the layer is not first"
        data = path.read_bytes()
        for info in infos:
            assert info.compress_type == zipfile.ZIP_STORED, f"{info.filename} is compressed"
            name, extra = struct.unpack_from("<HH", data, info.header_offset + 26)
            assert (info.header_offset + 30 + name + extra) % 64 == 0, f"{info.filename} is not aligned"
        return [info.filename for info in infos]


def of_vertices(primvar, corners, count):
    """The value of each vertex, where all corners that name it have the same: in linden's files always."""
    values = np.array(primvar.ComputeFlattened(), dtype=np.float64)
    # Readers of indices that pass over the interpolation take them for those of corners.
    assert (primvar.GetInterpolation() == "faceVarying") == primvar.IsIndexed(), "indices of vertices"
    if not primvar.IsIndexed():
        return values
    assert len(values) == len(corners), "texture coordinates of another number of corners"
    corners = np.minimum(corners, count)  # what is too large is told of later
    of_vertex = np.zeros((count + 1, values.shape[1]))
    of_vertex[corners] = values
    assert (of_vertex[corners] == values).all(), "corners of a vertex differ in st"
    return of_vertex[:count]


def usda(path):
    from pxr import Usd, UsdGeom, UsdPhysics, UsdShade

    stage = Usd.Stage.Open(str(path))
    assert stage, "usd-core cannot open it"
    root = stage.GetDefaultPrim()
    assert root, "no defaultPrim"
    assert UsdGeom.GetStageUpAxis(stage) == "Y" and UsdGeom.GetStageMetersPerUnit(stage) == 1
    tree = Tree()
    tree.recipe = root.GetAttribute("userProperties:linden:recipe").Get() or ""
    assert root.GetCustomDataByKey("linden:recipe") == tree.recipe, "customData has another recipe"
    packed = entries(path) if path.suffix == ".usdz" else None

    def mesh_of(prim):
        mesh = UsdGeom.Mesh(prim)
        counts = np.array(mesh.GetFaceVertexCountsAttr().Get())
        assert (counts == 3).all(), "a face is no triangle"
        numbers = lambda attribute: np.array(attribute.Get(), dtype=np.float64)
        st = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
        assert mesh.GetNormalsInterpolation() == "vertex"
        indices = np.array(st.GetIndices() or [0])
        assert 0 <= indices.min() and indices.max() < len(st.Get()), "an index of st names no value"
        triangles = np.array(mesh.GetFaceVertexIndicesAttr().Get()).astype(np.int64)
        assert len(triangles) == 3 * len(counts), "faceVertexCounts and faceVertexIndices disagree"
        points = numbers(mesh.GetPointsAttr())
        assert UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0], "no material is bound"
        return Mesh(
            prim.GetName(), points, numbers(mesh.GetNormalsAttr()), of_vertices(st, triangles, len(points)),
            triangles.reshape(-1, 3), tuple(np.array(p) for p in mesh.GetExtentAttr().Get()))

    cache = UsdGeom.XformCache()
    column = lambda matrix: np.array(matrix).T  # pxr's vectors are rows
    walk = iter(Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()))
    for prim in walk:
        if prim.IsA(UsdGeom.PointInstancer):
            walk.PruneChildren()
            is_cover = prim.GetName().startswith("Ground")
            into = tree.around if is_cover else tree.meshes
            if not is_cover:
                tree.is_instanced = tree.is_rounded = True
            instancer = UsdGeom.PointInstancer(prim)
            places = instancer.ComputeInstanceTransformsAtTime(0, 0)
            prototypes = instancer.GetPrototypesRel().GetTargets()
            above = column(cache.GetLocalToWorldTransform(prim))
            for which, place in zip(instancer.GetProtoIndicesAttr().Get(), places):
                prototype = stage.GetPrimAtPath(prototypes[which])
                assert not prototype.IsInstanceable(), "a prototype is instanceable"
                for own in Usd.PrimRange(prototype):
                    if own.IsA(UsdGeom.Mesh) and not own.HasAPI(UsdPhysics.CollisionAPI):
                        into.append(moved(mesh_of(own), above @ column(place)))
        elif prim.IsA(UsdGeom.Mesh) and prim.HasAPI(UsdPhysics.CollisionAPI):
            assert UsdGeom.Imageable(prim).ComputePurpose() == UsdGeom.Tokens.guide
        elif prim.IsA(UsdGeom.Mesh):
            into = tree.around if prim.GetName().startswith("Ground") else tree.meshes
            into.append(moved(mesh_of(prim), column(cache.GetLocalToWorldTransform(prim))))
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
                if packed is None:
                    tree.files.append(path.parent / file.Get().path)
                else:
                    assert file.Get().path.removeprefix("./") in packed, f"{file.Get()} is not in the package"
    return tree
