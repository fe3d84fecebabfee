#!/usr/bin/env python3
"""Whether usd-core finds each season in every USD file of a directory: the same wood, point by point,
and as many leaves as expected.json says, which another program counted in other files."""

import json
import sys
from pathlib import Path

from pxr import Usd, UsdGeom, UsdShade


def seen(stage):
    """Triangles of wood and of leaves, the points of the wood, and where the leaves' materials are."""
    wood, leaves, points, looks = 0, 0, None, set()
    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.Mesh):
            continue
        mesh = UsdGeom.Mesh(prim)
        count = len(mesh.GetFaceVertexCountsAttr().Get())
        if "_wood" in prim.GetName():
            wood += count
            points = [tuple(point) for point in mesh.GetPointsAttr().Get()]
        else:
            leaves += count
            material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
            assert material, prim.GetPath()
            looks.add(str(material.GetPath()))
    return wood, leaves, points, frozenset(looks)


def main():
    folder = Path(sys.argv[1])
    expected = json.loads((folder / "expected.json").read_text())
    chosen = expected.pop("chosen")
    files = [path for path in folder.iterdir() if path.suffix.startswith(".usd")]
    assert len(files) == 3, files
    for path in files:
        stage = Usd.Stage.Open(str(path))
        sets = stage.GetDefaultPrim().GetVariantSets()
        assert "season" in sets.GetNames(), sets.GetNames()
        lods = [None]
        if "lod" in sets.GetNames():
            lods = sets.GetVariantSet("lod").GetVariantNames()
            assert len(lods) == 2, lods
        for lod in lods:
            if lod:
                sets.GetVariantSet("lod").SetVariantSelection(lod)
            season_set = sets.GetVariantSet("season")
            assert season_set.GetVariantSelection() == chosen, season_set.GetVariantSelection()
            names = season_set.GetVariantNames()
            assert sorted(names) == sorted(expected), (names, expected)
            found = {}
            for name in names:
                season_set.SetVariantSelection(name)
                found[name] = seen(stage)
                wood, leaves, points, _ = found[name]
                assert points == found[names[0]][2], f"{path.name}: the wood of {name} is another"
                if lod in (None, "LOD0"):
                    assert [wood, leaves] == expected[name], (path.name, name, wood, leaves)
            if lod == "LOD1":
                counts = {name: own[1] for name, own in found.items()}
                assert 0 == counts["bare"] < counts["late"] < counts["summer"] < expected["summer"][1], counts
            assert found["flush"][3] != found["summer"][3] != found["autumn"][3], "seasons look the same"
            season_set.SetVariantSelection(chosen)
        print(path.name, {name: own[:2] for name, own in found.items()})


if __name__ == "__main__":
    main()
