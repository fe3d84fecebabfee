#!/usr/bin/env python3
"""Renders plants at several budgets of triangles, in three seasons and from near with Blender's Cycles, a row for each:

    cargo build --release
    python tests/render/budgets.py presets/pictures/budgets-cycles.jpg [--linden target/release/linden]
                                   [--plants oak,ash] [--peer NAME=FILE ...] [--size 300] [--samples 24]

A peer is a model of another program (.glb, .obj, .usda), which has a row with its one model. All are framed alike: by their
height, from eye height. Runs where `render.py` runs (pip install bpy==5.0.1 pillow).
"""

import argparse
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import bpy
from mathutils import Vector
from PIL import Image, ImageDraw

sys.path.insert(0, str(Path(__file__).parent))
from render import light, load  # noqa: E402

PLANTS = "oak,ash,silver-birch,norway-spruce,kanzan-cherry,apple"
SUMMER, AUTUMN, WINTER = (["--set", f"season={season}"] for season in (0.4, 0.75, 0.98))
# What stands over a column, what linden is told, and whether the foot is shown from near.
COLUMNS = [
    ("5 000 triangles", ["--triangles", "5000"], False),
    ("20 000", ["--triangles", "20000"], False),
    ("100 000", ["--triangles", "100000"], False),
    ("all", [], False),
    ("autumn, 20 000", ["--triangles", "20000", *AUTUMN], False),
    ("winter, all", WINTER, False),
    ("from near", [], True),
]
LABEL = 18


def stand(meshes, is_near):
    """A camera that shows a plant whole, or its foot."""
    corners = [o.matrix_world @ Vector(c) for o in meshes for c in o.bound_box]
    low, high = Vector(map(min, zip(*corners))), Vector(map(max, zip(*corners)))
    height = high.z
    # The longest of what has to be seen.
    reach = max(height, 0.9 * max(high.x - low.x, high.y - low.y))
    camera = bpy.data.cameras.new("camera")
    camera.lens, camera.clip_end = 50, 1000 * reach
    middle, size = (Vector((0, 0, 1.1)), 3.2) if is_near else (Vector((0, 0, height / 2)), 1.08 * reach)
    away = 0.5 * size / math.tan(camera.angle / 2)
    looking = bpy.data.objects.new("camera", camera)
    toward = Vector((0.35, -1, 0.1)).normalized()
    looking.location = middle + toward * away
    looking.rotation_euler = (-toward).to_track_quat("-Z", "Y").to_euler()
    bpy.context.collection.objects.link(looking)
    bpy.context.scene.camera = looking
    bpy.ops.mesh.primitive_plane_add(size=400 * reach, location=(0, 0, 0))
    ground = bpy.data.materials.new("ground")
    ground.use_nodes = True
    ground.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.24, 0.22, 0.16, 1)
    ground.node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 1
    bpy.context.object.data.materials.append(ground)


def rendered(file, is_near, size, samples):
    meshes = load(file)
    triangles = sum(len(o.data.polygons) for o in meshes)
    light()
    stand(meshes, is_near)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.seed = samples, 1
    scene.cycles.use_denoising = False
    # Leaves stand behind leaves: a ray goes through what is cut out of many.
    scene.cycles.transparent_max_bounces = 128
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x = scene.render.resolution_y = size
    picture = file.with_suffix(".png")
    scene.render.filepath = str(picture)
    bpy.ops.render.render(write_still=True)
    return Image.open(picture).convert("RGB"), triangles


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--linden", default="target/release/linden")
    parser.add_argument("--plants", default=PLANTS)
    parser.add_argument("--peer", action="append", default=[], metavar="NAME=FILE")
    parser.add_argument("--size", type=int, default=300)
    parser.add_argument("--samples", type=int, default=24)
    arguments = parser.parse_args()
    plants = arguments.plants.split(",")
    size = arguments.size
    sheet = Image.new("RGB", (size * len(COLUMNS), (size + LABEL) * (len(plants) + len(arguments.peer))), "white")
    draw = ImageDraw.Draw(sheet)

    def put(row, column, picture, label):
        left, top = size * column, (size + LABEL) * row
        draw.text((left + 4, top + 3), label, fill="black")
        sheet.paste(picture, (left, top + LABEL))
        print(label, flush=True)

    with tempfile.TemporaryDirectory() as folder:
        for row, plant in enumerate(plants):
            for column, (title, words, is_near) in enumerate(COLUMNS):
                file = Path(folder) / f"{column}.glb"
                subprocess.run([arguments.linden, "export", plant, *words, "-o", str(file)], check=True, capture_output=True)
                picture, triangles = rendered(file, is_near, size, arguments.samples)
                put(row, column, picture, f"{plant}, {title} ({triangles:,})" if "all" in title else f"{plant}, {title}")
        for row, peer in enumerate(arguments.peer, len(plants)):
            name, file = peer.split("=", 1)
            copy = Path(folder) / f"peer{Path(file).suffix}"
            copy.write_bytes(Path(file).read_bytes())
            picture, triangles = rendered(copy, False, size, arguments.samples)
            put(row, 0, picture, f"{name} ({triangles:,})")
    sheet.save(arguments.out, quality=88)


if __name__ == "__main__":
    main()
