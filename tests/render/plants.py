#!/usr/bin/env python3
"""Renders every plant as GLB and as USDA with Blender's Cycles, side by side on one picture:

    cargo build --release
    python tests/render/plants.py presets/pictures/plants-cycles.png [--linden target/release/linden]

Runs where `render.py` runs (pip install bpy==5.0.1 pillow). Says how far the two renders of a plant are
apart: mean absolute difference of all pixels, of 255; exits with 1 where that is more than light explains.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw

# Everything is drawn here, and nothing of it kept in the folder of the user.
os.environ["LINDEN_CACHE"] = "off"

HERE = Path(__file__).resolve().parent
PLANTS = HERE.parent.parent / "presets" / "plants"
# As much as a picture of this size can show.
KNOBS = ["--set", "triangles=250000", "--set", "bark_size=256"]
RENDER, CELL, LABEL, COLUMNS = 288, 110, 14, 6
MOST_DIFFERENCE = 1.0


def render(linden, plant):
    """Renders of the GLB and of the USDA."""
    with tempfile.TemporaryDirectory() as directory:
        files = [Path(directory) / f"{plant}.{ending}" for ending in ("glb", "usda")]
        outputs = [argument for file in files for argument in ("-o", file)]
        subprocess.run([linden, "export", plant, *KNOBS, *outputs], check=True, capture_output=True)
        pictures = []
        for file in files:
            picture = Path(directory) / f"{file.suffix[1:]}.png"
            subprocess.run([sys.executable, HERE / "render.py", file, picture, "--size", str(RENDER)],
                           check=True, capture_output=True)
            pictures.append(Image.open(picture).convert("RGB"))
    return pictures


def cropped(picture, box):
    """Beyond the picture is its background."""
    left, top, right, bottom = box
    whole = Image.new("RGB", (right - left, bottom - top), picture.getpixel((2, 2)))
    whole.paste(picture, (-left, -top))
    return whole.resize((CELL, CELL), Image.LANCZOS)


def around(picture):
    """The square around what differs from the background."""
    pixels = np.asarray(picture, float)
    rows, columns = np.where(np.abs(pixels - pixels[2, 2]).sum(axis=2) > 30)
    middle = np.array([columns.min() + columns.max(), rows.min() + rows.max()]) / 2
    reach = max(np.ptp(columns), np.ptp(rows)) / 2 + 6
    return tuple(int(x) for x in (*(middle - reach), *(middle + reach)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("--linden", default="target/release/linden")
    own = parser.parse_args()
    plants = sorted(path.stem for path in PLANTS.glob("*.toml"))
    with ThreadPoolExecutor(2) as pool:
        pairs = list(pool.map(lambda plant: render(own.linden, plant), plants))
    rows = -(-len(plants) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * 2 * CELL, rows * (CELL + LABEL)), (159, 172, 194))
    draw = ImageDraw.Draw(sheet)
    faults = 0
    for k, (plant, (glb, usda)) in enumerate(zip(plants, pairs)):
        difference = np.abs(np.asarray(glb, float) - np.asarray(usda, float)).mean()
        faults += difference > MOST_DIFFERENCE
        print(f"{plant}: {difference:.2f}")
        x, y = k % COLUMNS * 2 * CELL, k // COLUMNS * (CELL + LABEL)
        box = around(glb)
        for i, picture in enumerate((glb, usda)):
            sheet.paste(cropped(picture, box), (x + i * CELL, y))
        draw.text((x + 6, y + CELL + 1), plant, fill=(20, 25, 35))
    sheet.quantize(256, Image.Quantize.MAXCOVERAGE).save(own.output, optimize=True)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
