#!/usr/bin/env python3
"""Breaks good files in every way that matters and asserts that `check.py` notices:

    target/clients/venv/bin/python tests/clients/test_check.py DIRECTORY

DIRECTORY holds tree.{obj,ply,gltf,glb,usda,stl} and tree_skeleton.ply. A check that has never failed is
no check.
"""

import json
import re
import shutil
import struct
import sys
import tempfile
from pathlib import Path

import numpy as np

import check
import readers

BREAKAGES = []


def breakage(file, expected, by="geometry", clients=False):
    """Registers a function that breaks `file` such that the check `by` says `expected`."""
    def register(function):
        BREAKAGES.append((function.__name__, file, expected, by, clients, function))
        return function
    return register


# ---- text formats: one substitution each

def substitute(name, file, expected, pattern, replacement, by="geometry", clients=False, count=1):
    def function(path):
        text = path.read_text(encoding="utf-8")
        changed, found = re.subn(pattern, replacement, text, count=count, flags=re.M)
        assert found, f"{name}: nothing to break"
        path.write_text(changed, encoding="utf-8")
    function.__name__ = name
    breakage(file, expected, by, clients)(function)


NUMBER = r"-?[0-9.e-]+"
substitute("obj_nan", "tree.obj", "position is not finite", r"^v \S+", "v nan")
substitute("obj_long_normal", "tree.obj", "a normal is", r"^vn (\S+) (\S+) (\S+)$", r"vn 2 0 0")
substitute("obj_short_uvs", "tree.obj", "vt and vn differ", r"^vt .*\n", "")
substitute("obj_index", "tree.obj", "not there", r"^f \S+", "f 99999/99999/99999")
substitute("obj_mixed_indices", "tree.obj", "AssertionError", r"^f (\d+)/(\d+)/", r"f \1/2/")
substitute("obj_four_numbers", "tree.obj", "has 4 numbers", r"^v (.*)$", r"v \1 1")
substitute("obj_winding", "tree.obj", "wind against", r"^f (\S+) (\S+) ", r"f \2 \1 ")
substitute("obj_library", "tree.obj", "not there", r"^mtllib .*", "mtllib other.mtl")
substitute("obj_picture", "tree.mtl", "not there", r"^map_Kd .*", "map_Kd other.png")
substitute("obj_recipe", "tree.obj", "carries no recipe", r"^# recipe: .*\n", "")
substitute("obj_other_recipe", "tree.obj", "another recipe", r"^# recipe: .*", "# recipe: {}", by="agreement")
substitute("obj_lost_triangle", "tree.obj", "triangles, tree", r"^f .*\n(?=f)", "", by="agreement")
substitute("obj_open", "tree.obj", "open or inside out", r"^f .*\n(?=f)", "", by="trimesh", clients=True)
substitute("usda_nan", "tree.usda", "position is not finite", rf"(points = \[)\({NUMBER}", r"\1(nan")
substitute("usda_long_normal", "tree.usda", "a normal is", r"(normals = \[)\([^)]*\)", r"\1(0, 2, 0)")
substitute("usda_short_st", "tree.usda", "names no value", r"(primvars:st = \[)\([^)]*\), ", r"\1")
substitute("usda_short_indices", "tree.usda", "texture coordinates", r"(primvars:st:indices = \[)\d+, ", r"\1")
substitute("usda_index", "tree.usda", "not there", r"(faceVertexIndices = \[)\d+", r"\g<1>999999")
substitute("usda_winding", "tree.usda", "wind against", r"((?:faceVertexIndices|st:indices) = \[)(\d+), (\d+)", r"\1\3, \2",
           count=2)
substitute("usda_extent", "tree.usda", "declares bounds", rf"(extent = \[)\({NUMBER}", r"\1(-9")
substitute("usda_anchor", "tree.usda", "not anchored", r"@\./", "@")
substitute("usda_picture", "tree.usda", "not there", r"@\./[^@]*@", "@./other.png@")
substitute("usda_up_axis", "tree.usda", "AssertionError", r'upAxis = "Y"', 'upAxis = "Z"')
substitute("usda_binding", "tree.usda", "no material is bound", r"rel material:binding = .*", "")
substitute("usda_counts", "tree.usda", "disagree", r"(faceVertexCounts = \[)3, ", r"\1")
substitute("usda_curves", "tree.usda", "curve arrays disagree", r"(widths = \[)[^,]*, ", r"\1")
substitute("usda_syntax", "tree.usda", "geometry", r"def Mesh", "def Mesh Mesh", by="geometry")
substitute("usda_flipped_v", "tree.usda", "texture", rf"(primvars:st = )(\[[^]]*\])",
           lambda m: m[1] + re.sub(rf"\(({NUMBER}), ({NUMBER})\)",
                                   lambda v: f"({v[1]}, {1 - float(v[2])})", m[2]), by="agreement")
substitute("nvidia_extent", "tree.usda", "ExtentsChecker", rf"(extent = \[)\({NUMBER}", r"\1(-9",
           by="nvidia", clients=True)
substitute("nvidia_winding", "tree.usda", "NormalsWindings", r"(orientation = )\"rightHanded\"",
           r'\1"leftHanded"', by="nvidia", clients=True)
substitute("usd_core_texture", "tree.usda", "", r'"raw"', '"sRGB"', by="usd-core", clients=True)
substitute("usd_core_reference", "tree.usda", "", r"@\./[^@]*@", "@./other.png@", by="usd-core", clients=True)
substitute("gltf_bounds", "tree.gltf", "declares bounds", r'("VEC3","min":\[[^]]*\]),"max":\[[^]]*\]', r'\1,"max":[9,9,9]')
substitute("gltf_picture", "tree.gltf", "not there", r'"uri":"tree_bark.png"', '"uri":"other.png"')
substitute("gltf_length", "tree.gltf", "byteLength", r'"byteLength":\d+', '"byteLength":12')
substitute("khronos_bounds", "tree.gltf", "ACCESSOR_MAX_MISMATCH", r'("VEC3","min":\[[^]]*\]),"max":\[[^]]*\]', r'\1,"max":[9,9,9]',
           by="khronos", clients=True)


# ---- binary formats: one array edited in place

def edit_gltf(path, attribute, change):
    """Lets `change` edit an array of the first mesh (and its document)."""
    document = json.loads(path.read_text())
    binary = path.with_suffix(".bin")
    data = bytearray(binary.read_bytes())
    primitive = document["meshes"][0]["primitives"][0]
    index = primitive["indices"] if attribute == "indices" else primitive["attributes"][attribute]
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    dtype = {5123: "<u2", 5125: "<u4", 5126: "<f4"}[accessor["componentType"]]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
    array = np.frombuffer(data, dtype, accessor["count"] * width, view["byteOffset"]).reshape(-1, width)
    change(array)
    binary.write_bytes(data)


def gltf_edit(name, expected, attribute, change, by="geometry", clients=False):
    def function(path):
        edit_gltf(path, attribute, change)
    function.__name__ = name
    breakage("tree.gltf", expected, by, clients)(function)


def put(row, column, value):
    def change(array):
        array[row, column] = value
    return change


def swap(array):
    array[[0, 1]] = array[[1, 0]]


def flip(array):
    array[:, 1] = 1 - array[:, 1]


def lengthen(array):
    array[5] *= 3


gltf_edit("gltf_nan", "position is not finite", "POSITION", put(5, 1, np.nan))
gltf_edit("gltf_long_normal", "a normal is", "NORMAL", lengthen)
gltf_edit("gltf_index", "not there", "indices", put(4, 0, 60_000))
gltf_edit("gltf_winding", "wind against", "indices", swap)
gltf_edit("gltf_flipped_v", "area, texture or bounds", "TEXCOORD_0", flip, by="agreement")
gltf_edit("gltf_moved_vertex", "declares bounds", "POSITION", put(5, 1, 50.0))
gltf_edit("gltf_tangent_side", "has no side", "TANGENT", put(5, 3, 0.0))
gltf_edit("gltf_tangent_off", "leaves the surface", "TANGENT", put(slice(None), slice(0, 3), 0.577))
gltf_edit("khronos_nan", "ACCESSOR_INVALID_FLOAT", "POSITION", put(5, 1, np.nan), by="khronos", clients=True)
gltf_edit("khronos_index", "ACCESSOR_INDEX_OOB", "indices", put(4, 0, 60_000), by="khronos", clients=True)


@breakage("tree.glb", "header disagrees")
def glb_length(path):
    data = bytearray(path.read_bytes())
    struct.pack_into("<I", data, 8, len(data) + 4)
    path.write_bytes(data)


@breakage("tree.glb", "", by="geometry")
def glb_cut_short(path):
    path.write_bytes(path.read_bytes()[:-100])


def ply_edit(name, file, expected, change, by="geometry", clients=False):
    """`change` edits the body of a binary PLY."""
    def function(path):
        head, end, body = path.read_bytes().partition(b"end_header\n")
        path.write_bytes(head + end + bytes(change(bytearray(body), head)))
    function.__name__ = name
    breakage(file, expected, by, clients)(function)


def pack(kind, value, row=0, size=0, offset=0, faces=False):
    def change(body, head):
        start = int(re.search(rb"element vertex (\d+)", head)[1]) * 36 if faces else 0
        struct.pack_into(kind, body, start + row * size + offset, value)
        return body
    return change


def ply_swap(body, head):
    start = int(re.search(rb"element vertex (\d+)", head)[1]) * 36
    body[start + 1:start + 5], body[start + 5:start + 9] = body[start + 5:start + 9], body[start + 1:start + 5]
    return body


def ply_scale(body, head):
    count = int(re.search(rb"element vertex (\d+)", head)[1])
    vertices = np.frombuffer(body, [("position", "<f4", 3), ("rest", "u1", 24)], count)
    vertices["position"] *= 1.01
    return body


ply_edit("ply_nan", "tree.ply", "position is not finite", pack("<f", np.nan, 3, 36))
ply_edit("ply_long_normal", "tree.ply", "a normal is", pack("<f", 3.0, 3, 36, 12))
ply_edit("ply_index", "tree.ply", "not there", pack("<i", 99_999, 2, 13, 1, faces=True))
ply_edit("ply_negative_index", "tree.ply", "not there", pack("<i", -1, 2, 13, 1, faces=True))
ply_edit("ply_no_triangle", "tree.ply", "no triangle", pack("B", 4, 2, 13, faces=True))
ply_edit("ply_winding", "tree.ply", "wind against", ply_swap)
ply_edit("ply_scaled", "tree.ply", "area, texture or bounds", ply_scale, by="agreement")
ply_edit("ply_too_long", "tree.ply", "after the last", lambda body, _: body + b"x")
ply_edit("ply_too_short", "tree.ply", "", lambda body, _: body[:-5])
ply_edit("skeleton_radius", "tree_skeleton.ply", "not above zero", pack("<f", 0.0, 2, 48, 12))
ply_edit("skeleton_nan", "tree_skeleton.ply", "not finite", pack("<f", np.inf, 2, 48))
ply_edit("skeleton_edge", "tree_skeleton.ply", "node that is not there", pack("<i", 77, 13, 48))


# ---- STL: the first triangle's numbers

def stl_edit(name, expected, change, by="geometry", clients=False):
    def function(path):
        path.write_bytes(change(bytearray(path.read_bytes())))
    function.__name__ = name
    breakage("tree.stl", expected, by, clients)(function)


def stl_number(at, number):
    def change(data):
        struct.pack_into("<f", data, 84 + 4 * at, number)
        return data
    return change


def stl_swap(data):
    data[96:108], data[108:120] = data[108:120], data[96:108]
    return data


def stl_scale(data):
    table = np.frombuffer(data, readers.STL_TRIANGLE, offset=84)
    table["corners"] *= 1.01
    return data


def stl_lost(data):
    (count,) = struct.unpack_from("<I", data, 80)
    struct.pack_into("<I", data, 80, count - 1)
    return data[:-50]


stl_edit("stl_nan", "position is not finite", stl_number(3, np.nan))
stl_edit("stl_long_normal", "a normal is", stl_number(0, 3.0))
stl_edit("stl_winding", "wind against", stl_swap)
stl_edit("stl_scaled", "area, texture or bounds", stl_scale, by="agreement")
stl_edit("stl_lost_triangle", "triangles, tree", stl_lost, by="agreement")
stl_edit("stl_too_short", "bytes for", lambda data: data[:-5])
stl_edit("stl_text", "looks like text", lambda data: data.replace(b"binary", b"solid ", 1))


def main():
    good = Path(sys.argv[1])
    faults, _ = check.check(good)
    missed = [f"the good files have faults: {faults}"] if faults else []
    for name, file, expected, by, clients, function in BREAKAGES:
        with tempfile.TemporaryDirectory() as directory:
            copy = Path(directory)
            for path in good.iterdir():
                # For the slow clients only what they read.
                if not clients or path.stem.split("_")[0] == "tree":
                    shutil.copy(path, copy)
            if clients:
                for path in copy.iterdir():
                    if path.suffix in (".obj", ".ply", ".gltf", ".glb", ".usda", ".stl") and path.name != file:
                        path.unlink()
            function(copy / file)
            faults, _ = check.check(copy, clients)
            if not any(check_ == by and expected in f"{check_}: {fault}" for _, check_, fault in faults):
                missed.append(f"{name}: {by} did not say '{expected}' but {faults}")
    for line in missed:
        print(line)
    print(f"{len(BREAKAGES) - len(missed)} of {len(BREAKAGES)} breakages were caught")
    sys.exit(1 if missed else 0)


if __name__ == "__main__":
    main()
