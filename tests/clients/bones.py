"""Files whose trees sway by joints: what usd-core makes of the joints in USD, beside the same tree out of its GLB,
skinned here:

    target/clients/venv/bin/python tests/clients/bones.py DIRECTORY

Of each STEM.usd* there is a STEM.glb. Extents that are declared hold all points, and are those that usd-core computes.

    … tests/clients/bones.py SWAY.glb BONES.glb

measures how far joints are from the morph targets of the same tree: mean, 95 % and most, as shares of the largest way of a vertex.
"""

import json
import struct
import sys
from pathlib import Path

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdSkel

TYPES = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
# Metres: single precision along a chain of joints.
NEAR_M = 2e-4


class Glb:
    """A binary glTF without compression and fewer bits."""

    def __init__(self, path):
        data = path.read_bytes()
        length, = struct.unpack_from("<I", data, 12)
        self.json = json.loads(data[20:20 + length])
        self.buffer = data[20 + length + 8:]

    def array(self, index):
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        width = WIDTHS[accessor["type"]]
        found = np.frombuffer(self.buffer, TYPES[accessor["componentType"]], accessor["count"] * width, start)
        found = found.reshape(-1, width)
        return found / 255 if accessor.get("normalized") else found

    def frames(self):
        sampler = self.json["animations"][0]["samplers"][0]
        return self.json["accessors"][sampler["input"]]["count"]

    def worlds(self, frame):
        """The matrix of each node, for columns."""
        nodes, turns = self.json["nodes"], {}
        for channel in self.json["animations"][0]["channels"]:
            assert channel["target"]["path"] == "rotation"
            sampler = self.json["animations"][0]["samplers"][channel["sampler"]]
            turns[channel["target"]["node"]] = self.array(sampler["output"])[frame]
        worlds = {}

        def walk(index, above):
            node = nodes[index]
            x, y, z, w = np.array(turns.get(index, node.get("rotation", [0, 0, 0, 1])), float)
            matrix = np.eye(4)
            matrix[:3, :3] = [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
            matrix[:3, :3] *= np.array(node.get("scale", [1, 1, 1]))
            matrix[:3, 3] = node.get("translation", [0, 0, 0])
            worlds[index] = above @ matrix
            for child in node.get("children", []):
                walk(child, worlds[index])

        for root in self.json["scenes"][0]["nodes"]:
            walk(root, np.eye(4))
        return worlds

    def morphed(self, frame):
        """As `skinned`, of meshes with morph targets that stand at the origin."""
        found, weights = {}, {}
        for channel in self.json["animations"][0]["channels"]:
            sampler = self.json["animations"][0]["samplers"][channel["sampler"]]
            weights[channel["target"]["node"]] = self.array(sampler["output"]).reshape(self.frames(), -1)[frame]
        for index, node in enumerate(self.json["nodes"]):
            if "mesh" not in node or index not in weights:
                continue
            primitive = self.json["meshes"][node["mesh"]]["primitives"][0]
            rest = self.array(primitive["attributes"]["POSITION"]).astype(float)
            ways = [self.array(target["POSITION"]).astype(float) for target in primitive["targets"]]
            found[node["name"]] = rest, rest + sum(weight * way for weight, way in zip(weights[index], ways))
        return found

    def skinned(self, frame):
        """The vertices of all meshes, by the name of the node."""
        worlds, found = self.worlds(frame), {}
        for node in self.json["nodes"]:
            if "skin" not in node:
                continue
            skin = self.json["skins"][node["skin"]]
            unbind = self.array(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
            carry = np.array([worlds[joint] @ back for joint, back in zip(skin["joints"], unbind)])
            parts = []
            for primitive in self.json["meshes"][node["mesh"]]["primitives"]:
                names = primitive["attributes"]
                points = self.array(names["POSITION"]).astype(float)
                points = np.concatenate([points, np.ones((len(points), 1))], axis=1)
                joints, weights = self.array(names["JOINTS_0"]).astype(int), self.array(names["WEIGHTS_0"])
                assert np.abs(weights.sum(axis=1) - 1).max() < 1e-6
                parts.append(np.einsum("vk,vkij,vj->vi", weights, carry[joints], points)[:, :3])
            found[node["name"]] = np.concatenate(parts)
        return found


def check(path):
    stage = Usd.Stage.Open(str(path))
    first, last = int(stage.GetStartTimeCode()), int(stage.GetEndTimeCode())
    root = next(UsdSkel.Root(prim) for prim in stage.Traverse() if prim.IsA(UsdSkel.Root))
    extent = UsdGeom.Boundable(root).GetExtentAttr()
    assert extent.GetNumTimeSamples() == last - first + 1, "a frame has no extent"
    declared = [np.array(extent.Get(frame)) for frame in range(first, last + 1)]
    for frame in range(first, last + 1, 7):
        computed = np.array(UsdGeom.Boundable.ComputeExtentFromPlugins(UsdGeom.Boundable(root), frame))
        apart = np.abs(computed - declared[frame - first]).max()
        assert apart < NEAR_M, f"frame {frame}: declared {declared[frame - first].tolist()}, computed {computed.tolist()}"
    skeleton = next(UsdSkel.Skeleton(prim) for prim in stage.Traverse() if prim.IsA(UsdSkel.Skeleton))
    topology = UsdSkel.Topology(skeleton.GetJointsAttr().Get())
    valid = topology.Validate()
    assert valid if isinstance(valid, bool) else valid[0], "joints are out of order"
    assert UsdSkel.BakeSkinning(root, Gf.Interval.GetFullInterval()), "usd-core bakes nothing"
    twin = Glb(path.with_suffix(".glb"))
    assert twin.frames() == last - first + 1
    worst, widest, beyond = 0, 0, 0
    for frame in range(first, last + 1, 13):
        ours = twin.skinned(frame - first)
        for mesh in (UsdGeom.Mesh(prim) for prim in Usd.PrimRange(root.GetPrim()) if prim.IsA(UsdGeom.Mesh)):
            points = np.array(mesh.GetPointsAttr().Get(frame))
            worst = max(worst, np.abs(points - ours[mesh.GetPrim().GetName()]).max())
            widest = max(widest, np.abs(points - np.array(mesh.GetPointsAttr().Get(first))).max())
            low, high = declared[frame - first]
            beyond = max(beyond, (low - points).max(), (points - high).max())
    assert worst < NEAR_M, f"usd-core's points are {worst} m from those of the GLB"
    assert widest > 1e-2, "nothing moves"
    assert beyond < 0.05 * widest, f"points are {beyond} m beyond the declared extent"
    print(f"{path.name}: points of usd-core within {worst:.1e} m, which move by {widest:.3f} m")


def measure(sway, bones):
    sway, bones = Glb(sway), Glb(bones)
    gaps, most = {"wood": [], "all": []}, 0
    for frame in range(0, sway.frames() - 1, (sway.frames() - 1) // 7):
        turned = bones.skinned(frame)
        for name, (rest, moved) in sway.morphed(frame).items():
            gap = np.linalg.norm(moved - turned[name], axis=1)
            most = max(most, np.linalg.norm(moved - rest, axis=1).max())
            gaps["all"].append(gap)
            if "_wood" in name:
                gaps["wood"].append(gap)
    for what, found in gaps.items():
        found = 100 * np.concatenate(found) / most
        print(f"{what}: mean {found.mean():.1f} %, 95 % {np.percentile(found, 95):.1f} %, most {found.max():.1f} % of {most:.2f} m")


if __name__ == "__main__":
    if len(sys.argv) == 3:
        sys.exit(measure(Path(sys.argv[1]), Path(sys.argv[2])))
    for file in sorted(Path(sys.argv[1]).glob("*.usd*")):
        try:
            check(file)
        except AssertionError as error:
            sys.exit(f"{file.name}: {error}")
