#!/usr/bin/env python3
"""Whether usd-core finds levels of detail and seasons in every USD file of a directory."""

import sys
from pathlib import Path

from pxr import Usd, UsdGeom, UsdShade


def triangles(stage):
    meshes = [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    return sum(len(mesh.GetFaceVertexCountsAttr().Get()) for mesh in meshes)


def colors(stage):
    found = set()
    for prim in stage.Traverse():
        if prim.IsA(UsdGeom.Mesh):
            material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
            found.add(tuple(UsdShade.Shader(stage.GetPrimAtPath(material.GetPath().AppendChild("Surface")))
                            .GetInput("diffuseColor").Get() or ()))
    return found


def main():
    files = [path for path in Path(sys.argv[1]).iterdir() if path.suffix.startswith(".usd")]
    assert files, "no USD file"
    for path in files:
        stage = Usd.Stage.Open(str(path))
        sets = stage.GetDefaultPrim().GetVariantSets()
        assert sets.GetNames() == ["lod", "season"], sets.GetNames()
        counts = {}
        for lod in sets.GetVariantSet("lod").GetVariantNames():
            sets.GetVariantSet("lod").SetVariantSelection(lod)
            seasons = sets.GetVariantSet("season").GetVariantNames()
            assert sorted(seasons) == ["autumn", "summer"], seasons
            looks = []
            for season in seasons:
                sets.GetVariantSet("season").SetVariantSelection(season)
                counts.setdefault(lod, set()).add(triangles(stage))
                looks.append(colors(stage))
            assert looks[0] != looks[1], f"{path.name}: seasons look the same"
        assert all(len(own) == 1 for own in counts.values()), counts
        assert max(counts["LOD1"]) < min(counts["LOD0"]), counts
        print(path.name, counts)


if __name__ == "__main__":
    main()
