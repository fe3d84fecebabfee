"""Nanite assemblies as usd-core has them, held against what Unreal's schema asks for and against the tree itself:

    target/clients/venv/bin/python tests/clients/nanite.py DIRECTORY

All are of one tree. curves.usdc is no assembly: it has the tree's guide curves. Of each skeletal STEM.usd* there is a
STEM_wind.json. What bears a place is told by the wood: the joints of its nearest vertex.
"""

import json
import sys
from pathlib import Path

import numpy as np
from pxr import Sdf, Usd, UsdGeom, UsdSkel

BIND = "primvars:unreal:naniteAssembly:bindJoints"


def schemas(prim):
    # Unknown to usd-core: as they are authored.
    listed = prim.GetMetadata("apiSchemas")
    return listed.GetAddedOrExplicitItems() if listed else []


def below(prim, kind):
    return [each for each in Usd.PrimRange(prim) if each.IsA(kind)]


def of_schema(prim, name, kind):
    attribute = prim.GetAttribute(name)
    assert attribute and not attribute.IsCustom(), f"{prim.GetPath()}: no {name}"
    assert attribute.GetTypeName() == kind and attribute.GetVariability() == Sdf.VariabilityUniform, f"{name} is no uniform {kind}"
    return attribute


def parts(root, is_skeletal):
    """The instancers of an assembly, each whole."""
    instancers = [UsdGeom.PointInstancer(prim) for prim in below(root, UsdGeom.PointInstancer)]
    assert instancers, "there are no parts"
    for instancer in instancers:
        prim = instancer.GetPrim()
        assert prim.GetParent() == root, "an instancer is not right below the root"
        prototypes = [root.GetStage().GetPrimAtPath(path) for path in instancer.GetPrototypesRel().GetTargets()]
        assert prototypes and set(instancer.GetProtoIndicesAttr().Get()) == set(range(len(prototypes)))
        for prototype in prototypes:
            assert prototype.GetTypeName() == "Xform" and prim.GetPath().AppendChild("Prototypes") == prototype.GetPath().GetParentPath()
            mesh, = below(prototype, UsdGeom.Mesh)
            roots, skeletons = below(prototype, UsdSkel.Root), below(prototype, UsdSkel.Skeleton)
            assert (len(roots), len(skeletons)) == ((1, 1) if is_skeletal else (0, 0))
            if is_skeletal:
                assert len(UsdSkel.Skeleton(skeletons[0]).GetJointsAttr().Get()) == 1
                bound = UsdSkel.BindingAPI(mesh)
                assert UsdSkel.BindingAPI(mesh).GetInheritedSkeleton().GetPrim() == skeletons[0]
                count = len(UsdGeom.Mesh(mesh).GetPointsAttr().Get())
                assert list(bound.GetJointWeightsPrimvar().Get()) == [1.0] * count
                assert list(bound.GetJointIndicesPrimvar().Get()) == [0] * count
    return instancers


def bindings(instancer, joints):
    """The weight of each joint for each place."""
    prim = instancer.GetPrim()
    assert "NaniteAssemblySkelBindingAPI" in schemas(prim)
    named, weights = of_schema(prim, BIND, "token[]"), of_schema(prim, f"{BIND[:-1]}Weights", "float[]")
    each = named.GetMetadata("elementSize")
    assert each == weights.GetMetadata("elementSize")
    count = len(instancer.GetPositionsAttr().Get())
    names, shares = np.array(named.Get()).reshape(count, each), np.array(weights.Get()).reshape(count, each)
    number = {name: i for i, name in enumerate(joints)}
    assert set(names.ravel()) <= number.keys(), "a joint is not in the skeleton"
    of_joints = np.zeros((count, len(joints)))
    for slot in range(each):
        np.add.at(of_joints, (np.arange(count), [number[name] for name in names[:, slot]]), shares[:, slot])
    assert np.abs(of_joints.sum(axis=1) - 1).max() < 1e-5, "weights have another sum"
    return of_joints


def skinned(prim, joints):
    """The points of a mesh, and the weight of each joint for each."""
    api = UsdSkel.BindingAPI(prim)
    points = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get(), dtype=float)
    each = api.GetJointIndicesPrimvar().GetElementSize()
    indices = np.array(api.GetJointIndicesPrimvar().Get()).reshape(-1, each)
    weights = np.array(api.GetJointWeightsPrimvar().Get()).reshape(-1, each)
    of_joints = np.zeros((len(points), joints))
    for slot in range(each):
        np.add.at(of_joints, (np.arange(len(points)), indices[:, slot]), weights[:, slot])
    return points, of_joints


def moved(points, weights, matrices):
    points = np.concatenate([points, np.ones((len(points), 1))], axis=1)
    return np.einsum("vj,jki,vk->vi", weights, matrices, points)[:, :3]


def orders_of(path):
    """The order of each axis, from the guide curves of a file of the same tree."""
    stage = Usd.Stage.Open(str(path))
    curves, = below(stage.GetDefaultPrim(), UsdGeom.BasisCurves)
    return list(UsdGeom.PrimvarsAPI(curves).GetPrimvar("linden:order").Get())


def check(path, orders):
    stage = Usd.Stage.Open(str(path))
    root = stage.GetDefaultPrim()
    assert root.GetTypeName() == "Xform" and "NaniteAssemblyRootAPI" in schemas(root)
    assert Usd.ModelAPI(root).GetKind() == "group", "Unreal makes one mesh of a component"
    kind = of_schema(root, "unreal:naniteAssembly:meshType", "token").Get()
    skeletons = root.GetRelationship("unreal:naniteAssembly:skeleton").GetTargets() if kind == "skeletalMesh" else []
    instancers = parts(root, kind == "skeletalMesh")
    wind = path.with_name(f"{path.stem}_wind.json")
    if kind == "staticMesh":
        assert not below(root, UsdSkel.Root) and not below(root, UsdSkel.Skeleton) and not wind.exists()
        assert not any("skel:" in name for prim in Usd.PrimRange(root) for name in prim.GetPropertyNames())
        wood, = [each for each in instancers if each.GetPrim().GetName().startswith("wood")]
        assert list(wood.GetPositionsAttr().Get()) == [(0, 0, 0)] and list(wood.GetScalesAttr().Get()) == [(1, 1, 1)]
        print(f"{path.name}: {len(instancers)} instancers")
        return
    assert kind == "skeletalMesh"
    skeleton = UsdSkel.Skeleton(stage.GetPrimAtPath(skeletons[0]))
    assert skeleton and skeleton.GetPath().HasPrefix(root.GetPath()), "the skeleton is not below the root"
    paths, joints = list(skeleton.GetJointsAttr().Get()), list(skeleton.GetJointNamesAttr().Get())
    assert joints == [each.rsplit("/", 1)[-1] for each in paths] and len(set(joints)) == len(joints)

    base = UsdSkel.Root.Find(skeleton.GetPrim()).GetPrim()
    wood = [skinned(prim, len(joints)) for prim in below(base, UsdGeom.Mesh)]
    points, weights = np.concatenate([each for each, _ in wood]), np.concatenate([each for _, each in wood])
    cache = UsdSkel.Cache()
    cache.Populate(UsdSkel.Root(base), Usd.PrimDefaultPredicate)
    posed = np.array(cache.GetSkelQuery(skeleton).ComputeSkinningTransforms(Usd.TimeCode(stage.GetEndTimeCode() // 5)))
    borne = far = 0
    for instancer in instancers:
        places, of_places = np.array(instancer.GetPositionsAttr().Get(), dtype=float), bindings(instancer, joints)
        nearest = np.array([np.square(points - place).sum(axis=1).argmin() for place in places])
        # As much of the weights as the two have in common.
        common = np.minimum(of_places, weights[nearest]).sum(axis=1)
        borne += (common > 0.6).sum()
        far += len(places)
        apart = np.linalg.norm(places - points[nearest], axis=1)
        swung = np.linalg.norm(moved(places, of_places, posed) - moved(points[nearest], weights[nearest], posed), axis=1)
        assert np.quantile(swung - apart, 0.95) < 0.01, "leaves leave their twigs"
    assert borne > 0.9 * far, f"{far - borne} of {far} places go with other joints than the wood beside them"
    widest = np.abs(moved(points, weights, posed) - points).max()
    assert widest > 0.01, "nothing moves"

    told = json.loads(wind.read_text())
    assert [row["JointName"] for row in told["Joints"]] == joints, "the wind has other joints"
    groups = [row["SimulationGroupIndex"] for row in told["Joints"]]
    # `joint_AXIS_NUMBER`; what all hang on goes with the stems.
    of_axes = [orders[int(name.split("_")[1])] if "_" in name else 0 for name in joints]
    assert groups == of_axes, "groups are no orders of branches"
    assert len(told["SimulationGroups"]) == max(groups) + 1
    trunks = [row["bIsTrunkGroup"] for row in told["SimulationGroups"]]
    assert trunks == [True] + [False] * max(groups)
    shares = [row["Influence"] for row in told["SimulationGroups"]]
    assert max(shares) == 1 and min(shares) > 0 and not any(row["bUseDualInfluence"] for row in told["SimulationGroups"])
    assert told["GustAttenuation"] == 0.5 and told["bIsGroundCover"] is False
    print(f"{path.name}: {far} places, {borne} with the joints of the wood beside them; groups {shares}")


def main():
    directory = Path(sys.argv[1])
    found = sorted(set(directory.glob("*.usd*")) - {directory / "curves.usdc"})
    assert found
    for path in found:
        check(path, orders_of(directory / "curves.usdc"))


if __name__ == "__main__":
    main()
