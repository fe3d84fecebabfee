#!/usr/bin/env python3
"""Whether the assemblies of a directory hold each plant where expected.json says: every vertex of the plants' own
files, moved by numpy, is compared with what usd-core composes and with what a tileset's transforms make of it."""

import json
import sys
from pathlib import Path
from urllib.parse import unquote

import numpy as np
from pxr import Kind, Usd, UsdGeom

import check
import readers


def vertices(path):
    return np.concatenate([mesh.positions for mesh in readers.read(path).meshes]).astype(float)


def moved(points, place):
    turn = np.radians(place["turn_deg"])
    x, y, z = (points * place["scale"]).T
    turned = np.stack([np.cos(turn) * x + np.sin(turn) * z, y, np.cos(turn) * z - np.sin(turn) * x], axis=1)
    return turned + place["position"]


def same(found, expected):
    assert found.shape == expected.shape, (found.shape, expected.shape)
    slack = 1e-5 + 1e-9 * np.abs(expected).max()
    assert np.abs(found - expected).max() < slack, np.abs(found - expected).max()


def composed(prim):
    """The vertices of all meshes below a prim, in the world."""
    cache, points = UsdGeom.XformCache(), []
    for below in Usd.PrimRange(prim, Usd.TraverseInstanceProxies()):
        if below.IsA(UsdGeom.Mesh):
            matrix = np.array(cache.GetLocalToWorldTransform(below))
            local = np.array(UsdGeom.Mesh(below).GetPointsAttr().Get(), dtype=float)
            points.append(local @ matrix[:3, :3] + matrix[3, :3])
    return np.concatenate(points) if points else np.zeros((0, 3))


def within(points, low, high):
    slack = 1e-5 * (1 + np.abs(points).max())
    assert (points >= np.array(low) - slack).all() and (points <= np.array(high) + slack).all()


def usd(folder, expected):
    path = folder / f"{expected['name']}.usda"
    faults = list(check.with_usd_core(path)) + list(check.with_nvidia(path))
    assert not faults, faults
    stage = Usd.Stage.Open(str(path), Usd.Stage.LoadNone)
    root = stage.GetDefaultPrim()
    assert Kind.Registry.IsA(Usd.ModelAPI(root).GetKind(), "assembly")
    assert UsdGeom.GetStageUpAxis(stage) == "Y" and UsdGeom.GetStageMetersPerUnit(stage) == 1
    trees = [prim for prim in root.GetChild("Trees").GetFilteredChildren(Usd.PrimIsActive)]
    assert len(trees) == len(expected["places"])
    times = [place["index"] for place in expected["places"]]
    # What is not loaded has its box all the same.
    whole = UsdGeom.ModelAPI(root).GetExtentsHintAttr().Get()
    assert not any(prim.IsLoaded() for prim in trees)
    stage.Load()
    for prim, place in zip(trees, expected["places"]):
        said = prim.GetCustomDataByKey("linden")
        index = place["index"]
        assert said["index"] == index and said["seed"] == 2**64 - 1 - index and said["source"] == f'plant "{index}"'
        assert said["recipe"], "of the file itself"
        assert prim.IsInstance() == (times.count(index) > 1)
        own = vertices(folder / place["file"])
        points = composed(prim)
        same(points, moved(own, place))
        within(points, *whole)
        within(own, *UsdGeom.ModelAPI(prim).GetExtentsHintAttr().Get())


def up(points):
    return np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=1)


def corners(box):
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    return np.array(box[:3]) + signs @ np.array(box[3:]).reshape(3, 3)


def leaves(tile, parent=None):
    """All tiles with content; each lies within the tile above and is no less exact."""
    matrix = np.array(tile.get("transform", np.eye(4).T.flatten())).reshape(4, 4)
    box = corners(tile["boundingVolume"]["box"]) @ matrix[:3, :3] + matrix[3, :3]
    low, high = box.min(axis=0), box.max(axis=0)
    if parent:
        error, above_low, above_high = parent
        assert tile["geometricError"] <= error
        within(box, above_low, above_high)
    if "content" in tile:
        assert tile["geometricError"] == 0 and "children" not in tile
        yield tile, matrix
    else:
        assert "transform" not in tile
    for child in tile.get("children", []):
        yield from leaves(child, (tile["geometricError"], low - 1e-6, high + 1e-6))


def tiles(folder, expected):
    tileset = json.loads((folder / f"{expected['name']}.json").read_text())
    assert tileset["asset"]["version"] == "1.1"
    found = list(leaves(tileset["root"]))
    assert len(found) == len(expected["places"])
    unseen = list(expected["places"])
    for tile, matrix in found:
        at = matrix[3, [0, 2, 1]] * [1, 1, -1]
        place = next(p for p in unseen if np.abs(at - p["position"]).max() < 1e-9)
        unseen.remove(place)
        assert tile["extras"]["index"] == place["index"]
        path = folder / unquote(tile["content"]["uri"])
        assert path == folder / place["file"], path
        own = up(vertices(path))
        same(own @ matrix[:3, :3] + matrix[3, :3], up(moved(vertices(path), place)))
        box = corners(tile["boundingVolume"]["box"])
        within(own, box.min(axis=0), box.max(axis=0))


def many(folder, expected):
    path = folder / "many.usda"
    stage = Usd.Stage.Open(str(path), Usd.Stage.LoadNone)
    trees = stage.GetDefaultPrim().GetChild("Trees").GetFilteredChildren(Usd.PrimIsActive)
    assert len(trees) == expected["count"]
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default"], useExtentsHint=True)
    assert cache.ComputeWorldBound(stage.GetDefaultPrim()).ComputeAlignedRange().GetSize()[0] > 100
    for loaded in expected["loaded"]:
        prim = stage.Load(f"{stage.GetDefaultPrim().GetPath()}/Trees/{loaded['prim']}")
        same(composed(prim), moved(vertices(folder / loaded["file"]), {**loaded, "turn_deg": 0, "scale": 1}))
    assert sum(prim.IsLoaded() for prim in trees) == len(expected["loaded"])
    tileset = json.loads((folder / "many.json").read_text())
    assert sum(1 for _ in leaves(tileset["root"])) == expected["count"]


def main():
    folder = Path(sys.argv[1])
    expected = json.loads((folder / "expected.json").read_text())
    for assembly in expected["assemblies"]:
        (usd if assembly["name"].endswith("usd") else tiles)(folder, assembly)
    many(folder, expected["many"])


if __name__ == "__main__":
    main()
