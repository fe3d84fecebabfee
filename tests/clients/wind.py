"""The boxes that USD files with a sway loop declare, beside the points that usd-core bakes of their blend shapes:

    target/clients/venv/bin/python tests/clients/wind.py DIRECTORY
"""

import sys
from pathlib import Path

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdSkel


def check(path):
    stage = Usd.Stage.Open(str(path))
    declared, roots = {}, []
    first, last = int(stage.GetStartTimeCode()), int(stage.GetEndTimeCode())
    for prim in stage.Traverse():
        if prim.IsA(UsdSkel.Root):
            extent = UsdGeom.Boundable(prim).GetExtentAttr()
            assert extent.GetNumTimeSamples() == last - first + 1, "a frame has no extent"
            declared[prim.GetPath()] = [np.array(extent.Get(frame)) for frame in range(first, last + 1)]
            roots.append(prim)
    assert roots, "nothing sways"
    for prim in roots:
        assert UsdSkel.BakeSkinning(UsdSkel.Root(prim), Gf.Interval.GetFullInterval()), "usd-core bakes nothing"
    widest = 0
    for prim in roots:
        points = [UsdGeom.Mesh(mesh).GetPointsAttr() for mesh in Usd.PrimRange(prim) if mesh.IsA(UsdGeom.Mesh)]
        assert all(attribute.GetNumTimeSamples() for attribute in points), "a mesh stands still"
        for frame, box in enumerate(declared[prim.GetPath()], start=first):
            moved = np.concatenate([np.array(attribute.Get(frame)) for attribute in points])
            found = np.array([moved.min(axis=0), moved.max(axis=0)])
            assert np.abs(found - box).max() < 1e-4, f"frame {frame}: declared {box.tolist()}, is {found.tolist()}"
            widest = max(widest, np.abs(box - declared[prim.GetPath()][0]).max())
    assert widest > 1e-3, "the boxes are those of one frame"
    print(f"{path.name}: {last - first + 1} boxes, which move by {widest:.3f} m")


if __name__ == "__main__":
    for file in sorted(Path(sys.argv[1]).glob("*.usd*")):
        try:
            check(file)
        except AssertionError as error:
            sys.exit(f"{file.name}: {error}")
