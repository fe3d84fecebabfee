#!/usr/bin/env python3
"""Renders plants at several budgets of triangles, in three seasons and from near, a row for each, in Blender's Cycles or in
three.js:

    cargo build --release
    python tests/render/budgets.py presets/pictures/budgets-cycles.jpg [--linden target/release/linden]
                                   [--plants oak,ash] [--renderer cycles|three] [--peer PLANT=NAME=FILE ...]
                                   [--columns 5000,20000,near] [--size 300] [--samples 24]

A peer is a model of another program (.glb; in Cycles .obj and .usda as well), which stands at the end of the row of the
plant that it is like. All are framed alike: by their height, from eye height. Cycles runs where `render.py` runs (pip
install bpy==5.0.1 pillow); three.js needs Chromium and `npm ci --prefix tests/render/three`, where `peers.mjs` writes
models of ez-tree.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageDraw

# Everything is drawn here, and nothing of it kept in the folder of the user.
os.environ["LINDEN_CACHE"] = "off"

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

PLANTS = "oak,ash,silver-birch,norway-spruce,kanzan-cherry,apple"
SUMMER, AUTUMN, WINTER = (["--set", f"season={season}"] for season in (0.4, 0.75, 1))
# By name: what stands over a column, what linden is told, and from where it is seen.
COLUMNS = {
    "5000": ("5 000 triangles", ["--triangles", "5000"], "whole"),
    "20000": ("20 000", ["--triangles", "20000"], "whole"),
    "100000": ("100 000", ["--triangles", "100000"], "whole"),
    "all": ("all", [], "whole"),
    "autumn": ("autumn, 20 000", ["--triangles", "20000", *AUTUMN], "whole"),
    "winter": ("winter, all", WINTER, "whole"),
    "near": ("from near", [], "foot"),
    "leaves": ("leaves", [], "leaves"),
}
LABEL = 18


def in_cycles(shots, size, samples):
    """Draws `(model, view, picture)` and gives the triangles of each."""
    import bpy  # Before mathutils, which it brings.
    from mathutils import Vector
    from render import box_of, draw, light, load, look

    toward = Vector((0.35, -1, 0.1)).normalized()
    for model, view, picture in shots:
        meshes = load(model)
        triangles = sum(len(o.data.polygons) for o in meshes)
        light()
        low, high = box_of(meshes)
        # The longest of what has to be seen.
        reach = max(high.z, 0.9 * max(high.x - low.x, high.y - low.y))
        if view == "foot":
            look(Vector((0, 0, 1.1)), 3.2, toward)
        elif view == "leaves":
            # What stands out farthest to the camera at half the height.
            middle = max((o.matrix_world @ v.co for o in meshes for v in list(o.data.vertices)[::7]), key=lambda at: at.dot(toward) - 0.5 * abs(at.z - high.z / 2))
            look(middle, 1.2, toward)
        else:
            look(Vector((0, 0, high.z / 2)), 1.12 * reach, toward)
        bpy.ops.mesh.primitive_plane_add(size=400 * reach, location=(0, 0, 0))
        ground = bpy.data.materials.new("ground")
        ground.use_nodes = True
        surface = ground.node_tree.nodes["Principled BSDF"]
        surface.inputs["Base Color"].default_value = (0.24, 0.22, 0.16, 1)
        surface.inputs["Roughness"].default_value = 1
        bpy.context.object.data.materials.append(ground)
        draw(picture, size, samples, is_denoised=True)
        yield triangles


def in_three(shots, size, _samples):
    words = [word for model, view, picture in shots for word in ("--view", view, f"{model}={picture}")]
    drawn = subprocess.run(["node", HERE / "three" / "shoot.mjs", "--size", str(size), *words], check=True, stdout=subprocess.PIPE, text=True)
    for line in drawn.stdout.splitlines():
        yield int(line.rsplit(" ", 1)[1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--linden", default="target/release/linden")
    parser.add_argument("--plants", default=PLANTS)
    parser.add_argument("--columns", default=",".join(name for name in COLUMNS if name != "leaves"))
    parser.add_argument("--renderer", choices=["cycles", "three"], default="cycles")
    parser.add_argument("--peer", action="append", default=[], metavar="PLANT=NAME=FILE")
    parser.add_argument("--size", type=int, default=300)
    parser.add_argument("--samples", type=int, default=24)
    arguments = parser.parse_args()
    plants, columns = arguments.plants.split(","), arguments.columns.split(",")
    peers = {plant: [peer.split("=", 2)[1:] for peer in arguments.peer if peer.startswith(f"{plant}=")] for plant in plants}
    size = arguments.size
    across = len(columns) + max(map(len, peers.values()))
    sheet = Image.new("RGB", (size * across, (size + LABEL) * len(plants)), "white")
    pen = ImageDraw.Draw(sheet)
    draw = {"cycles": in_cycles, "three": in_three}[arguments.renderer]
    for row, plant in enumerate(plants):
        with tempfile.TemporaryDirectory() as folder:
            shots, titles = [], []
            for name in columns:
                title, words, view = COLUMNS[name]
                model = Path(folder) / f"{name}.glb"
                subprocess.run([arguments.linden, "export", plant, *words, "-o", model], check=True, capture_output=True)
                shots.append((model, view, model.with_suffix(".png")))
                titles.append(f"{plant}, {title}" + (" ({:,})" if "all" in title else ""))
            for number, (name, file) in enumerate(peers[plant]):
                shots.append((Path(file).resolve(), "whole", Path(folder) / f"peer-{number}.png"))
                titles.append(name + " ({:,})")
            for column, (shot, title, triangles) in enumerate(zip(shots, titles, draw(shots, size, arguments.samples))):
                left, top = size * column, (size + LABEL) * row
                pen.text((left + 4, top + 3), title.format(triangles), fill="black")
                sheet.paste(Image.open(shot[2]).convert("RGB").resize((size, size), Image.LANCZOS), (left, top + LABEL))
                print(title.format(triangles), flush=True)
    sheet.save(arguments.out, quality=88)


if __name__ == "__main__":
    main()
