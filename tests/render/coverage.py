#!/usr/bin/env python3
"""Compares levels of detail with the tree that they stand for, as Blender's Cycles shows both:

    python tests/render/coverage.py FULL.glb LEVEL.glb ... [--size 500] [--samples 32] [--views 0,120,240]
                                    [--pictures FOLDER]

From the same camera, on a transparent film: the pixels that the level covers (alpha over one half) as a share of those
of the full tree, both together over either (intersection over union), and how far the mean colours of what is covered
are apart (CIE 1976, in CIELAB), with the level's L, a and b less the tree's. A line for each level and direction, then the means of each level. Directions are degrees round
the tree. Runs in a Python with Blender as a module (pip install bpy==5.0.1 pillow, Python 3.11).
"""

import argparse
import math
import sys
import tempfile
from pathlib import Path

import bpy  # Before mathutils, which it brings.
import numpy
from mathutils import Vector
from PIL import Image

sys.path.insert(0, str(Path(__file__).parent))
from render import box_of, draw, light, load, look  # noqa: E402


def frame(box, degrees):
    """Shows a box whole, from a little above the horizon."""
    low, high = box
    middle, size = (low + high) / 2, (high - low).length
    turn = math.radians(degrees)
    toward = Vector((math.sin(turn), -math.cos(turn), 0.15)).normalized()
    look(middle, 0.95 * size, toward)


def render(size, samples, path):
    draw(path, size, samples, is_transparent=True)
    return numpy.asarray(Image.open(path).convert("RGBA"), dtype=float) / 255


def lab(rgb):
    """sRGB to CIELAB under D65."""
    linear = numpy.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    to_xyz = numpy.array([[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]])
    xyz = linear @ to_xyz.T / numpy.array([0.95047, 1.0, 1.08883])
    f = numpy.where(xyz > (6 / 29) ** 3, numpy.cbrt(xyz), xyz / (3 * (6 / 29) ** 2) + 4 / 29)
    return numpy.stack([116 * f[..., 1] - 16, 500 * (f[..., 0] - f[..., 1]), 200 * (f[..., 1] - f[..., 2])], -1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("full", type=Path)
    parser.add_argument("levels", type=Path, nargs="+")
    parser.add_argument("--size", type=int, default=500)
    parser.add_argument("--samples", type=int, default=32)
    parser.add_argument("--views", default="0,120,240")
    parser.add_argument("--pictures", type=Path)
    arguments = parser.parse_args()
    folder = arguments.pictures or Path(tempfile.mkdtemp())
    folder.mkdir(parents=True, exist_ok=True)
    views = [float(view) for view in arguments.views.split(",")]
    box, whole = None, {}
    for file in [arguments.full, *arguments.levels]:
        meshes = load(file.resolve())
        light()
        box = box or box_of(meshes)
        count = sum(len(m.data.polygons) for m in meshes)
        rows = []
        for view in views:
            frame(box, view)
            seen = render(arguments.size, arguments.samples, folder.resolve() / f"{file.stem}-{view:g}.png")
            covered = seen[..., 3] > 0.5
            color = lab(seen[..., :3][covered]).mean(axis=0)
            if file == arguments.full:
                whole[view] = (covered, color)
                continue
            all_covered, all_color = whole[view]
            rows.append((covered.sum() / all_covered.sum(), (covered & all_covered).sum() / (covered | all_covered).sum(),
                         numpy.linalg.norm(color - all_color)))
            parts = "L {:+.1f} a {:+.1f} b {:+.1f}".format(*(color - all_color))
            print("{}\t{} triangles\t{:g}°\tcovered {:.3f}\tIoU {:.3f}\tΔE {:.1f}\t{}".format(file.name, count, view, *rows[-1], parts))
        if rows:
            print("{}\t{} triangles\tmean\tcovered {:.3f}\tIoU {:.3f}\tΔE {:.1f}".format(file.name, count, *numpy.mean(rows, axis=0)), flush=True)


if __name__ == "__main__":
    main()
