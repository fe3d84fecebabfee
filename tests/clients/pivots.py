"""Follows texels of Pivot Painter's pictures: python pivots.py FOLDER

The folder has attributes.glb and the same plant as pivots*.glb with its pictures, and axes.json, the axes by the skeleton. Decoded
is as Unreal's material functions do it: OpenEXR and Pillow read the pictures, numbers are taken apart below.
"""

import json
import sys
from pathlib import Path

import numpy as np
import OpenEXR
from PIL import Image

import readers


def arrays(path):
    """Names, positions and further attributes of all meshes of a GLB, and what their extras tell."""
    document, binary, _ = readers.container(path)
    for mesh in document["meshes"]:
        [primitive] = mesh["primitives"]

        def read(name):
            accessor = document["accessors"][primitive["attributes"][name]]
            view = document["bufferViews"][accessor["bufferView"]]
            dtype = np.dtype({5123: "<u2", 5126: "<f4"}[accessor["componentType"]])
            width = {"VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
            rows = np.lib.stride_tricks.as_strided(
                np.frombuffer(binary[view["byteOffset"]:], dtype), (accessor["count"], width),
                (view.get("byteStride", dtype.itemsize * width), dtype.itemsize)).astype(np.float64)
            return rows / 65535 if accessor.get("normalized") else rows

        yield mesh["name"], primitive["attributes"], read, mesh.get("extras", {}).get("linden_pivot_painter")


class Texels:
    """What the material functions make of the two pictures."""

    def __init__(self, folder, told):
        with OpenEXR.File(str(folder / told["pivots"]), separate_channels=True) as file:
            channels = {name: channel.pixels for name, channel in file.channels().items()}
        assert set(channels) == set("RGBA") and all(each.dtype == np.float16 for each in channels.values()), channels
        self.size = np.array(told["size"])
        assert channels["R"].shape == tuple(self.size[::-1]), f"{channels['R'].shape} in place of {self.size}"
        # Rows from the top, as an index counts.
        centimetres = np.stack([channels[name] for name in "RGB"], axis=-1).reshape(-1, 3).astype(np.float64)
        # Unreal's importer turns (x, y, z) metres into (x, z, y) centimetres; back again.
        self.pivots = centimetres[:, [0, 2, 1]] / 100
        # ms_PivotPainter2_UnpackIntegerAsFloat.
        self.parents = channels["A"].reshape(-1).view(np.uint16).astype(int) - 1024
        picture = Image.open(folder / told["axes"])
        assert picture.mode == "RGBA" and picture.size == tuple(self.size)
        pixels = np.asarray(picture).reshape(-1, 4) / 255
        # ms_PivotPainter2_DecodeAxisVector, before it makes the length 1, and …Decode8BitAlphaAxisExtent.
        self.axes = (pixels[:, :3] * 2 - 1)[:, [0, 2, 1]]
        self.reaches = np.maximum(8, pixels[:, 3] * 2048) / 100
        self.count = told["pieces"]

    def index(self, uvs):
        """ms_PivotPainter2_CalculateMeshElementIndex; all are in the middle of their texels."""
        places = uvs * self.size
        assert (np.abs(places - np.floor(places) - 0.5) < 0.02).all(), "a vertex is not in the middle of its texel"
        column, row = np.floor(places).astype(int).T
        index = row * self.size[0] + column
        assert (index < self.count).all(), "a vertex names a texel that is empty"
        return index


def turned(points, about, axis, angle):
    """Rodrigues' formula."""
    arm = points - about
    cos, sin = np.cos(angle), np.sin(angle)
    return about + arm * cos + np.cross(axis, arm) * sin + np.outer(arm @ axis, axis) * (1 - cos)


def swung(texels, piece, points, angle=0.2):
    """Points of a piece, turned by it and then by all that bear it, the stem last."""
    while True:
        axis = np.cross(texels.axes[piece], [0.3, 1.0, 0.2])
        points = turned(points, texels.pivots[piece], axis / np.linalg.norm(axis), angle)
        if texels.parents[piece] == piece:
            return points
        piece = texels.parents[piece]


def turn_axes(texels):
    texels.pivots = texels.pivots[:, [0, 2, 1]]


def mirror(texels):
    texels.axes = texels.axes * [1, 1, -1]


def hang_elsewhere(texels):
    texels.parents = np.where(texels.parents == 0, 1, texels.parents)


def shorten(texels):
    texels.reaches = 0.9 * texels.reaches


def upside_down(texels):
    index = texels.index
    texels.index = lambda uvs: index(np.stack([uvs[:, 0], 1 - uvs[:, 1]], axis=1))


def follow(folder, path, expected, spoil=lambda texels: None):
    told = next(extras for *_, extras in arrays(path) if extras)
    texels = Texels(folder, told)
    spoil(texels)
    assert (texels.parents[:texels.count] >= 0).all() and (texels.parents[:texels.count] < texels.count).all()
    half = lambda metres: np.abs(metres) * 2.0 ** -11 + 1e-6
    # Each axis of the skeleton down to the third level is one piece, borne by the piece of the axis that bears it.
    wanted = [axis for axis in expected if axis["level"] <= 3]
    assert texels.count == len(wanted), f"{texels.count} pieces of {len(wanted)} axes"
    number = {axis["axis"]: piece for piece, axis in enumerate(wanted)}
    for piece, axis in enumerate(wanted):
        assert texels.parents[piece] == number[axis["parent"]], f"{piece} hangs on {texels.parents[piece]}"
        assert (np.abs(texels.pivots[piece] - axis["pivot"]) <= half(np.array(axis["pivot"]))).all(), f"{piece} is elsewhere"
        length = np.linalg.norm(texels.axes[piece])
        assert abs(length - 1) < 0.01 and texels.axes[piece] @ axis["along"] > 0.9999 * length, f"{piece} looks elsewhere"
        level, at = 0, piece
        while texels.parents[at] != at:
            level, at = level + 1, texels.parents[at]
        assert level == axis["level"] and wanted[at]["level"] == 0, f"the chain of {piece} has {level} links"
        # What a branch turns about stays where what bears it has it.
        if piece != texels.parents[piece]:
            pivot = texels.pivots[[piece]]
            assert np.allclose(swung(texels, piece, pivot), swung(texels, texels.parents[piece], pivot))
    reach = np.zeros(texels.count)
    vertices = 0
    for (name, has, read, extras), (_, _, told_by, _) in zip(arrays(path), arrays(folder / "attributes.glb"), strict=True):
        assert extras == told and "_WIND" not in has and "COLOR_0" not in has, f"{name}: {has}, {extras}"
        index = texels.index(read("TEXCOORD_1"))
        wind, pivots = told_by("_WIND"), told_by("_WINDPIVOT")
        places = told_by("POSITION")
        along = ((places - texels.pivots[index]) * texels.axes[index]).sum(axis=1)
        np.maximum.at(reach, index, along)
        vertices += len(index)
        if (wind[:, 3] > 0).any():
            # A leaf's vertices are all of one piece, that of its twig, or of what bears that.
            feet, leaf = np.unique(pivots[:, :3], axis=0, return_inverse=True)
            for number_of_leaf in range(len(feet)):
                assert len(np.unique(index[leaf.ravel() == number_of_leaf])) == 1, f"{name}: a leaf hangs on two pieces"
            continue
        # Wood down to the third level has the pivots of the attributes.
        own = wind[:, 0] <= 3
        assert own.any() and (np.abs(texels.pivots[index] - pivots[:, :3]) <= half(pivots[:, :3]))[own].all(), f"{name}: other pivots"
        levels = np.array([axis["level"] for axis in wanted])
        assert (levels[index[own]] == wind[own, 0]).all() and (levels[index[~own]] == 3).all(), f"{name}: other levels"
    # A byte is some eight centimetres; directions are rounded.
    over = texels.reaches[:texels.count] - np.minimum(reach, 20.48)
    assert (over > -0.01 * reach - 1e-3).all() and (over < 0.085 + 0.01 * reach).all(), f"reaches are off by {over.min()} to {over.max()} m"
    print(f"{path.name}: {vertices} vertices, {texels.count} pieces, {texels.size} texels")


def main():
    folder = Path(sys.argv[1])
    expected = json.loads((folder / "axes.json").read_text())
    for path in sorted(folder.glob("pivots*.glb")):
        follow(folder, path, expected)
    # The same, read wrongly, is found out.
    for spoil in (turn_axes, mirror, hang_elsewhere, shorten, upside_down):
        try:
            follow(folder, path, expected, spoil)
        except AssertionError as fault:
            print(f"{spoil.__name__}: {fault}")
        else:
            sys.exit(f"{spoil.__name__} is not found out")


if __name__ == "__main__":
    main()
