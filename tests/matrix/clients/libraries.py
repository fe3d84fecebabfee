"""Opens files with a library of Python or with assimp, and says what is in each:

    python libraries.py assimp|trimesh|meshlab|tinyusdz|usd|arkit < tasks.json
"""

import json
import os
import subprocess
import sys
import tempfile
from collections import defaultdict
from importlib.metadata import version
from pathlib import Path

import numpy as np

# Libraries print; answers go where standard output went.
answers = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)


class Facts:
    """What is collected of a scene."""

    def __init__(self):
        self.told = defaultdict(int, materials={}, nodes=[], clips=[], second=[])
        self.points = []
        self.attributes = set()

    def mesh(self, points, count, matrix=np.eye(4)):
        """So many triangles between points, where a matrix (column vectors) puts them."""
        self.points.append(np.asarray(points).reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3])
        self.told["triangles"] += int(count)

    def second(self, vertices, pairs, corners):
        """Second texture coordinates of a mesh, and which of them the corners of its triangles have."""
        self.told["second"].append({"vertices": vertices, "pairs": np.asarray(pairs, dtype=float).tolist(), "corners": np.asarray(corners).tolist()})

    def done(self):
        points = np.vstack(self.points) if self.points else np.zeros((1, 3))
        box = [points.min(axis=0).tolist(), points.max(axis=0).tolist()]
        return {**self.told, "attributes": sorted(self.attributes), "box": None if self.told["joints"] else box}


def assimp(path):
    program = Path(sys.executable).with_name("assimp")
    with tempfile.TemporaryDirectory() as directory:
        out = Path(directory) / "out.json"
        done = subprocess.run([program, "export", path, out, "-fassjson"], capture_output=True, text=True, timeout=120, check=False)
        if not out.is_file():
            lines = [line for line in done.stdout.splitlines() if "ERROR" in line or "failed" in line] or done.stdout.splitlines()
            raise ValueError(f"{lines[-1] if lines else done.returncode}")
        scene = json.loads(out.read_text(errors="replace"))
    facts = Facts()
    meshes, used = scene.get("meshes", []), set()

    def visit(node, above):
        matrix = above @ np.array(node["transformation"], dtype=float).reshape(4, 4)
        facts.told["nodes"].append(node["name"])
        for index in node.get("meshes", []):
            mesh = meshes[index]
            if mesh["primitivetypes"] & 4:
                # What is not a number is written as a word.
                facts.mesh(np.array(mesh["vertices"], dtype=float), sum(len(face) - 2 for face in mesh["faces"] if len(face) > 2), matrix)
                used.add(mesh["materialindex"])
                for pairs, width in list(zip(mesh.get("texturecoords", []), mesh.get("numuvcomponents", [])))[1:2]:
                    facts.second(len(mesh["vertices"]) // 3, np.array(pairs, dtype=float).reshape(-1, width)[:, :2], [face for face in mesh["faces"] if len(face) == 3])
            else:
                facts.told["lines"] += len(mesh["faces"])
                facts.told["points"] += len(mesh["vertices"]) // 3
            facts.told["morphs"] = max(facts.told["morphs"], len(mesh.get("morphs", mesh.get("animmeshes", []))))
            facts.attributes |= {f"uv{i}" for i, _ in enumerate(mesh.get("texturecoords", []))} | {"color" for _ in mesh.get("colors", [])[:1]}
        for child in node.get("children", []):
            visit(child, matrix)

    visit(scene["rootnode"], np.eye(4))
    for index in used:
        values = defaultdict(dict)
        for each in scene["materials"][index]["properties"]:
            values[each["key"]][each["semantic"]] = each["value"]
        pictures, name = values["$tex.file"], values["?mat.name"].get(0, "")
        facts.told["materials"][name] = {
            "picture": bool({1, 12} & set(pictures)), "normals": bool({5, 6} & set(pictures)),
            "cut": values["$mat.gltf.alphaMode"].get(0) == "MASK" or 8 in pictures, "two": bool(values["$mat.twosided"].get(0)),
        }
    facts.told["joints"] = len({bone["name"] for mesh in meshes for bone in mesh.get("bones", [])})
    facts.told["clips"] = [[clip["name"], clip["duration"]] for clip in scene.get("animations", [])]
    facts.told["cameras"], facts.told["lights"] = len(scene.get("cameras", [])), len(scene.get("lights", []))
    return facts.done()


def with_trimesh(path):
    import trimesh

    scene = trimesh.load_scene(path, process=False)
    facts = Facts()
    facts.told["nodes"] = list(scene.graph.nodes)
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        mesh = scene.geometry[name]
        if not hasattr(mesh, "faces"):
            facts.told["points"] += len(mesh.vertices)
            facts.told["lines"] += sum(len(entity.points) - 1 for entity in getattr(mesh, "entities", []))
            continue
        facts.mesh(mesh.vertices, len(mesh.faces), matrix)
        facts.attributes |= set(mesh.vertex_attributes)
        if (pairs := mesh.vertex_attributes.get("TEXCOORD_1")) is not None:
            facts.second(len(mesh.vertices), pairs, mesh.faces)
        if mesh.visual.kind == "vertex":
            facts.attributes.add("color")
        material = getattr(mesh.visual, "material", None)
        if material is not None:
            picture = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
            normal = getattr(material, "normalTexture", None)
            if normal is None and hasattr(material, "kwargs"):
                normal = material.kwargs.get("map_bump") or material.kwargs.get("norm")
            facts.told["materials"][material.name] = {
                "picture": picture is not None, "normals": normal is not None,
                "cut": getattr(material, "alphaMode", None) == "MASK", "two": bool(getattr(material, "doubleSided", False)),
            }
    return facts.done()


def meshlab(path):
    import pymeshlab

    layers = pymeshlab.MeshSet()
    layers.load_new_mesh(str(path))
    facts = Facts()
    pictures = 0
    for mesh in layers:
        if mesh.face_number():
            facts.mesh(mesh.vertex_matrix(), mesh.face_number(), np.array(mesh.transform_matrix()))
        facts.told["lines"] += mesh.edge_number()
        facts.told["points"] += mesh.vertex_number()
        pictures += mesh.texture_number()
        if mesh.has_vertex_color():
            facts.attributes.add("color")
    facts.told["pictures"] = pictures
    return facts.done()


def tinyusdz(path):
    import tinyusdz
    from tinyusdz import tydra

    os.chdir(path.parent)
    scene = tydra.convert_to_render_scene(tinyusdz.load(str(path)))
    facts = Facts()
    meshes, materials = scene.meshes(), scene.materials()

    def visit(node):
        facts.told["nodes"].append(node.name)
        if node.node_type == "mesh" and 0 <= node.content_id < len(meshes):
            mesh = meshes[node.content_id]
            facts.mesh(np.array(mesh.points), np.array(mesh.face_vertex_counts).sum() - 2 * len(np.array(mesh.face_vertex_counts)),
                       np.array(node.global_matrix).T)
            corners = np.array(mesh.face_vertex_indices)
            if (pairs := mesh.texcoord(1)) is not None:
                facts.second(len(np.array(mesh.points)), np.array(pairs), corners)
            if 0 <= mesh.material_id < len(materials):
                material = materials[mesh.material_id]
                surface = material.preview_surface or {}
                image = lambda name: surface.get(name, {}).get("texture_id", -1) >= 0
                facts.told["materials"][material.name] = {
                    "picture": image("diffuse_color"), "normals": image("normal"),
                    "cut": image("opacity") and surface["opacity_threshold"]["value"] > 0, "two": mesh.is_double_sided,
                    "through": material.has_open_pbr,
                }
        for child in node.children():
            visit(child)

    for node in scene.nodes():
        visit(node)
    facts.told["joints"] = sum(skeleton.num_joints for skeleton in scene.skeletons())
    facts.told["clips"] = [[each.name, each.duration] for each in scene.animations()]
    facts.told["cameras"], facts.told["lights"] = len(scene.cameras()), len(scene.lights())
    return facts.done()


def usd(path):
    from pxr import Usd, UsdGeom, UsdPhysics, UsdShade, UsdSkel, UsdValidation

    stage = Usd.Stage.Open(str(path))
    facts = Facts()
    cache = UsdGeom.XformCache()

    def surface(material):
        shader = UsdShade.Material(material).ComputeSurfaceSource()[0]
        pictured = lambda name: bool(shader and (source := shader.GetInput(name)) and source.HasConnectedSource())
        through = UsdShade.Material(material).GetSurfaceOutput("mtlx")
        cut = shader and shader.GetInput("opacityThreshold")
        files = [UsdShade.Shader(child).GetInput("file") for child in material.GetChildren()]
        found = all(file.Get() and file.Get().resolvedPath for file in files if file)
        return {"picture": pictured("diffuseColor") and found, "normals": pictured("normal") and found,
                "cut": bool(cut and cut.Get() and cut.Get() > 0), "through": bool(through and through.HasConnectedSource())}

    def mesh_at(prim, matrix):
        mesh = UsdGeom.Mesh(prim)
        facts.mesh(mesh.GetPointsAttr().Get(), sum(n - 2 for n in mesh.GetFaceVertexCountsAttr().Get()), matrix)
        facts.attributes |= {each.GetPrimvarName() for each in UsdGeom.PrimvarsAPI(prim).GetPrimvars()}
        bound = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
        if st1 := UsdGeom.PrimvarsAPI(prim).GetPrimvar("st1"):
            corners, pairs = mesh.GetFaceVertexIndicesAttr().Get(), st1.ComputeFlattened()
            by_corner = st1.GetInterpolation() == "faceVarying"
            facts.second(len(pairs if by_corner else mesh.GetPointsAttr().Get()), pairs, range(len(corners)) if by_corner else corners)
        if bound:
            facts.told["materials"][bound.GetPrim().GetName()] = {**surface(bound.GetPrim()), "two": mesh.GetDoubleSidedAttr().Get()}
        if prim.HasAPI(UsdSkel.BindingAPI):
            facts.told["morphs"] = max(facts.told["morphs"], len(UsdSkel.BindingAPI(prim).GetBlendShapeTargetsRel().GetTargets()))

    world = lambda prim: np.array(cache.GetLocalToWorldTransform(prim)).T
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)):
        facts.told["nodes"].append(prim.GetName())
        facts.told["cameras"] += prim.IsA(UsdGeom.Camera)
        facts.told["lights"] += "Light" in prim.GetTypeName()
        facts.told["curves"] += prim.IsA(UsdGeom.BasisCurves) and len(UsdGeom.BasisCurves(prim).GetCurveVertexCountsAttr().Get())
        facts.told["bodies"] += prim.HasAPI(UsdPhysics.CollisionAPI)
        facts.told["proxies"] += prim.IsA(UsdGeom.Mesh) and UsdGeom.Imageable(prim).ComputePurpose() == "proxy"
        if prim.IsA(UsdSkel.Skeleton):
            facts.told["joints"] += len(UsdSkel.Skeleton(prim).GetJointsAttr().Get() or [])
        if prim.IsA(UsdSkel.Animation):
            animation = UsdSkel.Animation(prim)
            times = animation.GetRotationsAttr().GetTimeSamples() or animation.GetBlendShapeWeightsAttr().GetTimeSamples()
            facts.told["clips"].append([f"Wind {prim.GetName()}", len(times)])
        purpose = UsdGeom.Imageable(prim).ComputePurpose() if prim.IsA(UsdGeom.Imageable) else ""
        if prim.IsA(UsdGeom.PointInstancer):
            instancer = UsdGeom.PointInstancer(prim)
            targets = [stage.GetPrimAtPath(target) for target in instancer.GetPrototypesRel().GetTargets()]
            for place, index in zip(instancer.ComputeInstanceTransformsAtTime(0, 0), instancer.GetProtoIndicesAttr().Get()):
                facts.told["instances"] += 1
                for part in Usd.PrimRange(targets[index], Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)):
                    if part.IsA(UsdGeom.Mesh):
                        within = np.linalg.inv(world(targets[index])) @ world(part) if part != targets[index] else np.eye(4)
                        mesh_at(part, world(prim) @ np.array(place).T @ within)
        elif prim.IsA(UsdGeom.Mesh) and purpose in ("default", "render") and not under_instancer(prim):
            mesh_at(prim, world(prim))
    for prim in stage.Traverse():
        for name in prim.GetVariantSets().GetNames():
            facts.told.setdefault("variants", {})[name] = prim.GetVariantSets().GetVariantSet(name).GetVariantNames()
    messages = [f"composition: {error}" for error in stage.GetCompositionErrors()]
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    for error in UsdValidation.ValidationContext(validators).Validate(stage):
        # The wheel is built without MaterialX, and knows none of its nodes.
        is_materialx = "shaderId 'ND_" in error.GetMessage() and "sdrRegistry" in error.GetMessage()
        if error.GetType() in (UsdValidation.ValidationErrorType.Error, UsdValidation.ValidationErrorType.Warn) and not is_materialx:
            messages.append(f"{error.GetName()}: {error.GetMessage()}")
    facts.told["messages"] = messages
    return facts.done()


def under_instancer(prim):
    from pxr import UsdGeom

    while prim := prim.GetParent():
        if prim.IsA(UsdGeom.PointInstancer):
            return True
    return False


def arkit(path):
    from pxr import Sdr, Tf, UsdUtils

    # The wheel comes without the definitions of shaders, says so once, and finds every shader at fault.
    try:
        Sdr.Registry().GetNodeNames()
    except Tf.ErrorException:
        pass
    checker = UsdUtils.ComplianceChecker(arkit=True, skipARKitRootLayerCheck=False, rootPackageOnly=False, skipVariants=False, verbose=False)
    checker.CheckCompliance(str(path))
    messages = [*checker.GetErrors(), *checker.GetFailedChecks(), *checker.GetWarnings()]
    return {"messages": [message for message in messages if "has invalid shader node" not in message]}


OPENERS = {"assimp": assimp, "trimesh": with_trimesh, "meshlab": meshlab, "tinyusdz": tinyusdz, "usd": usd, "arkit": arkit}


PACKAGES = {"assimp": "cmeel-assimp", "meshlab": "pymeshlab", "usd": "usd-core", "arkit": "usd-core"}


def main():
    opener = OPENERS[sys.argv[1]]
    print(json.dumps({"version": version(PACKAGES.get(sys.argv[1], sys.argv[1]))}), file=answers)
    for task in json.load(sys.stdin):
        try:
            told = opener(Path(task["root"]) / task["file"])
        except Exception as e:
            told = {"error": f"{type(e).__name__}: {e}".strip()[:300]}
        print(json.dumps({"row": task["row"], **told}, default=int), file=answers, flush=True)


main()
