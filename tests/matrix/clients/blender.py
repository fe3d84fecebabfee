"""Opens files in Blender (bpy), and says what is in each: python blender.py < tasks.json"""

import json
import os
import sys

import bpy
import mathutils

# Importers print; answers go where standard output went.
answers = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)

IMPORTERS = {
    "glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    "gltf": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    "usda": lambda path: bpy.ops.wm.usd_import(filepath=path),
    "usdc": lambda path: bpy.ops.wm.usd_import(filepath=path),
    "usdz": lambda path: bpy.ops.wm.usd_import(filepath=path),
    "obj": lambda path: bpy.ops.wm.obj_import(filepath=path),
    "ply": lambda path: bpy.ops.wm.ply_import(filepath=path),
    "stl": lambda path: bpy.ops.wm.stl_import(filepath=path),
}
# Files that cannot say which axis is up are taken as they are.
AS_THEY_ARE = {"ply", "stl"}


def upstream(socket):
    """All nodes that a socket follows from."""
    for link in socket.links:
        yield link.from_node
        for other in link.from_node.inputs:
            yield from upstream(other)


def pictures(socket):
    return [node.image for node in upstream(socket) if node.type == "TEX_IMAGE" and node.image and node.image.size[0]]


def material(each):
    told = {"picture": False, "normals": False, "cut": False, "two": not each.use_backface_culling, "through": False}
    nodes = each.node_tree.nodes if each.node_tree else []
    for node in nodes:
        if node.type == "BSDF_PRINCIPLED":
            told["picture"] = bool(pictures(node.inputs["Base Color"]))
            # Directions that are taken for colours bend the light.
            normals = pictures(node.inputs["Normal"])
            told["normals"] = bool(normals) and all(image.colorspace_settings.is_data for image in normals)
            told["cut"] = node.inputs["Alpha"].is_linked
        told["through"] |= node.type == "BSDF_TRANSLUCENT"
    return told


def facts(ending):
    low, high = [float("inf")] * 3, [float("-inf")] * 3
    told = {"triangles": 0, "lines": 0, "points": 0, "curves": 0, "morphs": 0, "joints": 0, "instances": 0, "materials": {}, "nodes": [], "second": []}
    attributes = set()
    # As it stands in no wind.
    for armature in bpy.data.armatures:
        armature.pose_position = "REST"
    for keys in bpy.data.shape_keys:
        keys.animation_data_clear()
        for key in keys.key_blocks:
            key.value = 0.0
    bpy.context.view_layer.update()
    for place in bpy.context.evaluated_depsgraph_get().object_instances:
        thing = place.object
        if thing.type != "MESH" or thing.name.startswith("Icosphere"):
            continue
        if thing.hide_render:
            continue
        mesh = thing.data
        mesh.calc_loop_triangles()
        if not len(mesh.polygons):
            told["lines"] += len(mesh.edges)
            told["points"] += len(mesh.vertices)
            continue
        told["triangles"] += len(mesh.loop_triangles)
        told["instances"] += place.is_instance
        for corner in mesh.vertices:
            x, y, z = place.matrix_world @ corner.co
            at = (x, y, z) if ending in AS_THEY_ARE else (x, z, -y)
            low, high = [min(a, b) for a, b in zip(low, at)], [max(a, b) for a, b in zip(high, at)]
        attributes |= {attribute.name for attribute in mesh.attributes}
        attributes |= {f"uv:{layer.name}" for layer in mesh.uv_layers}
        for layer in mesh.uv_layers[1:2]:
            pairs = [0.0] * (2 * len(mesh.loops))
            layer.uv.foreach_get("vector", pairs)
            told["second"].append({"vertices": len(mesh.loops), "pairs": pairs, "corners": [i for each in mesh.loop_triangles for i in each.loops]})
        for slot in mesh.materials:
            if slot:
                told["materials"][slot.name] = material(slot)
    for thing in bpy.data.objects:
        told["nodes"].append(thing.name)
        told["curves"] += thing.type in ("CURVE", "CURVES")
    told["morphs"] = max((len(keys.key_blocks) - 1 for keys in bpy.data.shape_keys), default=0)
    # The importer of USD has blend shapes as keys, joints as armatures.
    told["joints"] = sum(len(armature.bones) for armature in bpy.data.armatures)
    told["clips"] = [[action.name, *action.frame_range] for action in bpy.data.actions]
    told["cameras"], told["lights"] = len(bpy.data.cameras), len(bpy.data.lights)
    told["attributes"] = sorted(attributes)
    told["box"] = [low, high]
    return told


def main():
    for task in json.load(sys.stdin):
        path = os.path.join(task["root"], task["file"])
        ending = path.rsplit(".", 1)[1]
        bpy.ops.wm.read_factory_settings(use_empty=True)
        try:
            IMPORTERS[ending](path)
            told = facts(ending)
            if not told["nodes"]:
                told = {"error": "imports nothing"}
        except Exception as e:
            told = {"error": str(e).strip().split("\n")[-1][:300]}
        print(json.dumps({"row": task["row"], **told}), file=answers, flush=True)


print(json.dumps({"version": bpy.app.version_string}), file=answers)
main()
