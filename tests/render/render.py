#!/usr/bin/env python3
"""Renders an exported file with Blender's Cycles, to see what Blender makes of it:

    python tests/render/render.py FILE OUT.png [--size 640] [--samples 32] [--view front|side|top|detail|own]
                                  [--translucent [SHARE] | --documented]

Runs in a Python with Blender as a module (pip install bpy==5.0.1, Python 3.11): `bpy` is large and
no test needs it. Reads .glb .gltf .obj .ply .usda .usd, frames what it finds, adds sun and sky.
`--translucent` lets light through what is cut out: no importer of Blender 5.0 reads that. `--documented` does it by the
script in docs/formats.md, twice, and wants it to find leaves.
`--view own` adds nothing: it shows a file that has its own camera and light (`linden export --scene`).
"""

import argparse
import math
import sys
from pathlib import Path

import bpy
from mathutils import Vector


def load(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    # As a new scene has it; a USD's dome light becomes its background.
    bpy.context.scene.world = bpy.data.worlds.new("World")
    kind = path.suffix.lower()
    if kind in (".glb", ".gltf"):
        bpy.ops.import_scene.gltf(filepath=str(path))
    elif kind == ".obj":
        bpy.ops.wm.obj_import(filepath=str(path))
    elif kind == ".ply":
        # PLY says nothing of axes that Blender reads; ours are Y-up.
        bpy.ops.wm.ply_import(filepath=str(path), forward_axis="NEGATIVE_Z", up_axis="Y")
    elif kind in (".usda", ".usd", ".usdc"):
        bpy.ops.wm.usd_import(filepath=str(path))
    else:
        sys.exit(f"no importer for {path.name}")
    meshes = [o for o in bpy.context.scene.objects if o.type == "MESH"]
    if not meshes:
        sys.exit(f"Blender found no mesh in {path.name}")
    return meshes


def show_vertex_colors(meshes):
    """A file without materials (PLY) is seen by its vertex colours."""
    for mesh in (o.data for o in meshes if not o.data.materials and o.data.color_attributes):
        material = bpy.data.materials.new("vertex colors")
        material.use_nodes = True
        nodes = material.node_tree
        color = nodes.nodes.new("ShaderNodeVertexColor")
        color.layer_name = mesh.color_attributes[0].name
        nodes.links.new(color.outputs["Color"], nodes.nodes["Principled BSDF"].inputs["Base Color"])
        mesh.materials.append(material)


def run_documented():
    text = (Path(__file__).parents[2] / "docs/formats.md").read_text()
    script = text.split("### Blender", 1)[1].split("```python\n", 1)[1].split("```", 1)[0]
    for _ in range(2):
        exec(script, {})
    for material in bpy.data.materials:
        kinds = [node.type for node in material.node_tree.nodes] if material.node_tree else []
        print(f"{material.name}: {kinds.count('BSDF_TRANSLUCENT')} translucent")
        assert kinds.count("BSDF_TRANSLUCENT") <= 1, f"{material.name}: once for each run"
    kinds = [node.type for material in bpy.data.materials if material.node_tree for node in material.node_tree.nodes]
    assert "BSDF_TRANSLUCENT" in kinds, "no leaves were found"


def let_light_through(share, tint=(0.95, 1.0, 0.5)):
    """Splits the colour of leaves between the side that is lit and the other one."""
    for material in bpy.data.materials:
        tree = material.node_tree
        surface = next((n for n in tree.nodes if n.type == "BSDF_PRINCIPLED"), None) if tree else None
        # Of what has two faces, of which each is seen from its own side, none goes through.
        if surface is None or not surface.inputs["Alpha"].is_linked or material.use_backface_culling:
            continue
        nodes, link = tree.nodes, tree.links.new
        color, alpha = (surface.inputs[name].links[0].from_socket for name in ("Base Color", "Alpha"))

        def times(factor):
            mix = nodes.new("ShaderNodeMix")
            mix.data_type, mix.blend_type = "RGBA", "MULTIPLY"
            mix.inputs["Factor"].default_value = 1
            link(color, mix.inputs[6])
            mix.inputs[7].default_value = (*factor, 1)
            return mix.outputs[2]

        through, both = nodes.new("ShaderNodeBsdfTranslucent"), nodes.new("ShaderNodeAddShader")
        hole, cut = nodes.new("ShaderNodeBsdfTransparent"), nodes.new("ShaderNodeMixShader")
        link(times([share * x for x in tint]), through.inputs["Color"])
        link(times([1 - share] * 3), surface.inputs["Base Color"])
        tree.links.remove(surface.inputs["Alpha"].links[0])
        link(surface.outputs[0], both.inputs[0])
        link(through.outputs[0], both.inputs[1])
        link(alpha, cut.inputs[0])
        link(hole.outputs[0], cut.inputs[1])
        link(both.outputs[0], cut.inputs[2])
        link(cut.outputs[0], nodes["Material Output"].inputs["Surface"])


def box_of(meshes):
    """The lowest and the highest corner of all."""
    corners = [o.matrix_world @ Vector(c) for o in meshes for c in o.bound_box]
    return Vector(map(min, zip(*corners))), Vector(map(max, zip(*corners)))


def look(middle, size, toward):
    """A camera in the direction `toward` that shows `size` metres around `middle`."""
    camera = bpy.data.cameras.new("camera")
    camera.lens = 50
    camera.clip_start, camera.clip_end = size / 1000, 1000 * size
    looking = bpy.data.objects.new("camera", camera)
    looking.location = middle + toward * (0.5 * size / math.tan(camera.angle / 2))
    looking.rotation_euler = (-toward).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(looking)
    bpy.context.scene.camera = looking


def draw(picture, size, samples, is_transparent=False, is_denoised=False):
    """What the camera sees, as a PNG of `size` pixels. Denoised it is for looking at; what is measured is not."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.film_transparent = is_transparent
    scene.cycles.samples, scene.cycles.seed = samples, 1
    scene.cycles.use_denoising = is_denoised
    # Leaves stand behind leaves: a ray goes through what is cut out of many.
    scene.cycles.transparent_max_bounces = 128
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.filepath = str(Path(picture).resolve())
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA" if is_transparent else "RGB"
    bpy.ops.render.render(write_still=True)


def frame(meshes, view):
    low, high = box_of(meshes)
    middle, size = (low + high) / 2, (high - low).length
    toward = {"front": Vector((0.25, -1, 0.15)), "side": Vector((1, 0.1, 0.15)),
              "top": Vector((0.01, -0.05, 1)), "detail": Vector((0.25, -1, 0.15))}[view].normalized()
    look(middle, size * (0.45 if view == "detail" else 1.05), toward)


def light():
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = 3
    sun.data.angle = math.radians(2)
    sun.rotation_euler = (math.radians(50), 0, math.radians(-35))
    bpy.context.collection.objects.link(sun)
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.55, 0.7, 0.9, 1)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.6
    bpy.context.scene.world = world


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--size", type=int, default=640)
    parser.add_argument("--samples", type=int, default=32)
    parser.add_argument("--view", choices=["front", "side", "top", "detail", "own"], default="front")
    parser.add_argument("--documented", action="store_true")
    parser.add_argument("--translucent", type=float, nargs="?", const=0.45, default=0.0, metavar="SHARE")
    arguments = parser.parse_args()
    meshes = load(arguments.file.resolve())
    show_vertex_colors(meshes)
    if arguments.documented:
        run_documented()
    if arguments.translucent:
        let_light_through(arguments.translucent)
    if arguments.view == "own":
        cameras = [o for o in bpy.context.scene.objects if o.type == "CAMERA"]
        if not cameras:
            sys.exit(f"{arguments.file.name} has no camera")
        bpy.context.scene.camera = cameras[0]
    else:
        frame(meshes, arguments.view)
        light()
    draw(arguments.out, arguments.size, arguments.samples)
    triangles = sum(len(m.data.loop_triangles) or len(m.data.polygons) for m in meshes)
    print(f"{arguments.file.name}: {len(meshes)} meshes, {triangles} triangles -> {arguments.out}")


if __name__ == "__main__":
    main()
