"""Whether usd-core finds the ages of a plant: `ages.py DIRECTORY`, in which ash.usda and ash.usdc lie beside the files of the
ages, young and grown."""

import sys
from pathlib import Path

from pxr import Usd, UsdGeom


def points(stage):
    meshes = [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    return sorted((mesh.GetPrim().GetName(), len(mesh.GetPointsAttr().Get())) for mesh in meshes)


def main():
    folder = Path(sys.argv[1])
    for ending in ("usda", "usdc"):
        stage = Usd.Stage.Open(str(folder / f"ash.{ending}"))
        plant = stage.GetDefaultPrim()
        sets = plant.GetVariantSets()
        assert sets.GetNames()[0] == "age", sets.GetNames()
        ages = sets.GetVariantSet("age")
        assert sorted(ages.GetVariantNames()) == ["grown", "young"], ages.GetVariantNames()
        assert ages.GetVariantSelection() == "grown", ages.GetVariantSelection()
        assert Usd.ModelAPI(plant).GetKind() == "component"
        seen = {}
        for age in ages.GetVariantNames():
            ages.SetVariantSelection(age)
            alone = Usd.Stage.Open(str(folder / f"ash_{age}.{ending}"))
            seen[age] = points(stage)
            assert seen[age] and seen[age] == points(alone), (ending, age)
            # The box that is known before the payload is.
            unloaded = Usd.Stage.Open(stage.GetRootLayer(), Usd.Stage.LoadNone)
            unloaded.GetDefaultPrim().GetVariantSets().GetVariantSet("age").SetVariantSelection(age)
            hint = UsdGeom.ModelAPI(unloaded.GetDefaultPrim()).GetExtentsHint()
            own = UsdGeom.ModelAPI(alone.GetDefaultPrim()).GetExtentsHint()
            assert len(hint) >= 2 and list(hint[:2]) == list(own[:2]), (hint, own)
            assert not points(unloaded), "the payload is loaded"
            # Levels of an age are chosen below it.
            assert "lod" in plant.GetVariantSets().GetNames(), plant.GetVariantSets().GetNames()
        assert sum(n for _, n in seen["young"]) < sum(n for _, n in seen["grown"])
        print(f"ash.{ending}", {age: len(found) for age, found in seen.items()})


if __name__ == "__main__":
    main()
