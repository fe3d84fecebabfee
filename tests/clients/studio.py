#!/usr/bin/env python3
"""Whether usd-core finds in every USD file of a directory what its name says: `WAY-NAME.FORMAT`.

Payloads hold what the whole file does, prim by prim; proxies are the coarsest level; labels are there.
"""

import sys
from pathlib import Path

from pxr import Kind, Usd, UsdGeom, UsdSemantics


def triangles(stage, purposes):
    total = 0
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)):
        mesh = UsdGeom.Mesh(prim)
        if mesh and mesh.ComputePurpose() in purposes and "Prototypes" not in str(prim.GetPath()):
            total += len(mesh.GetFaceVertexCountsAttr().Get())
        instancer = UsdGeom.PointInstancer(prim)
        if instancer and instancer.ComputePurpose() in purposes:
            prototypes = [stage.GetPrimAtPath(path) for path in instancer.GetPrototypesRel().GetTargets()]
            sizes = [len(UsdGeom.Mesh(each).GetFaceVertexCountsAttr().Get()) for each in prototypes]
            total += sum(sizes[index] for index in instancer.GetProtoIndicesAttr().Get())
    return total


def flat(stage):
    """Every attribute of every prim, by its path."""
    found = {}
    for prim in stage.Traverse():
        found[str(prim.GetPath())] = prim.GetTypeName()
        for attribute in prim.GetAttributes():
            if attribute.GetName() != "userProperties:linden:payload":
                found[str(attribute.GetPath())] = str(attribute.Get(0))
        for relation in prim.GetRelationships():
            found[str(relation.GetPath())] = str(relation.GetTargets())
    return found


def main():
    files = [path for path in sorted(Path(sys.argv[1]).iterdir()) if path.suffix.startswith(".usd")]
    files = [path for path in files if not path.stem.endswith("_payload")]
    assert len(files) == 36, len(files)
    for path in files:
        way, name = path.stem.split("-")
        stage = Usd.Stage.Open(str(path))
        assert not stage.GetCompositionErrors(), path
        root = stage.GetDefaultPrim()
        model = Usd.ModelAPI(root)
        assert model.GetKind() == Kind.Tokens.component, path
        assert model.GetAssetName() and model.GetAssetVersion() == "1", path
        hint = UsdGeom.ModelAPI(root).GetExtentsHint()
        assert len(hint) == 2 and hint[0][1] < hint[1][1], path
        labels = UsdSemantics.LabelsAPI.ComputeInheritedTaxonomies(root)
        assert labels == ([] if name == "ar" else ["class"]), (path, labels)
        if name != "ar":
            words = UsdSemantics.LabelsAPI(root, "class").GetLabelsAttr().Get()
            assert list(words) == ["plant", model.GetAssetName()], (path, words)
            for prim in stage.Traverse():
                if prim.IsA(UsdGeom.Mesh) and UsdGeom.Mesh(prim).ComputePurpose() != "guide":
                    assert UsdSemantics.LabelsAPI(prim, "class").GetLabelsAttr().Get(), prim
        is_split = name in ("payload", "both", "both_instances")
        identifier = model.GetAssetIdentifier()
        assert (identifier.path if identifier else "") == (f"./{path.name}" if is_split else ""), path
        sets = root.GetVariantSets()
        levels = sets.GetVariantSet("lod").GetVariantNames()
        assert len(levels) == {"still": 3, "sway": 2, "single": 0}[way], (path, levels)
        has_proxy = way != "single" and ("proxy" in name or "both" in name)
        proxy = triangles(stage, ["proxy"])
        assert (proxy > 0) == has_proxy, path
        if has_proxy:
            geometry = root.GetChild("Geometry")
            assert UsdGeom.Imageable(geometry).ComputeProxyPrim()[0] == root.GetChild("Proxy"), path
            assert triangles(stage, ["default"]) == 0, path
            sets.GetVariantSet("lod").SetVariantSelection(levels[-1])
            last = triangles(stage, ["render"])
            assert proxy == last if last <= 5000 else 2000 < proxy < last, (path, proxy, last)
            sets.GetVariantSet("lod").SetVariantSelection(levels[0])
            assert triangles(stage, ["render"]) > proxy, path
        if name == "payload":
            for level in levels or [None]:
                both = []
                for other in (path, path.with_stem(f"{way}-whole")):
                    opened = Usd.Stage.Open(str(other))
                    if level:
                        opened.GetDefaultPrim().GetVariantSet("lod").SetVariantSelection(level)
                    # Pictures are named after the file.
                    both.append({key: value.replace(other.stem, "") for key, value in flat(opened).items()})
                same = both[0] == both[1]
                assert same, (path, [(key, both[0].get(key, "")[:80], both[1].get(key, "")[:80])
                                     for key in both[0].keys() | both[1].keys()
                                     if both[0].get(key) != both[1].get(key)][:5])
        if is_split:
            unloaded = Usd.Stage.Open(str(path), Usd.Stage.LoadNone)
            root = unloaded.GetDefaultPrim()
            assert root.HasPayload() and not root.IsLoaded() and not root.GetChildren(), path
            assert UsdGeom.ModelAPI(root).GetExtentsHint() == hint, path
            assert path.stat().st_size < 40_000, (path, path.stat().st_size)
            # What can be chosen is known before it is loaded.
            assert root.GetVariantSets().GetVariantSet("lod").GetVariantNames() == levels, path
        print(path.name, proxy)


if __name__ == "__main__":
    main()
