#!/usr/bin/env python3
"""Opens a page of the format `html` in a headless Chromium, as a file and without the net, and compares what it shows with
a preview:

    linden export oak -o oak.html --triangles 30000
    linden preview oak -o oak.png --triangles 30000 --background transparent
    python tests/render/html.py oak.html oak.png [--least 0.8] [--season autumn] [--picture SHOT.png]

Both are cut to what is covered and brought to one size: the pixels that both cover as a share of those that either does. Runs
in a Python with pillow and numpy; Chromium is `$CHROMIUM`, or the one in the path.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy
from PIL import Image

SIDE = 240
# The page's name and its buttons are no part of the tree.
BARS = {"top": 70, "bottom": 60}


def shot(page, path, dark, season):
    """What Chromium shows of a page."""
    command = [
        os.environ.get("CHROMIUM", "chromium"), "--headless=new", "--no-sandbox", "--hide-scrollbars",
        "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist",
        "--window-size=800,1000", "--virtual-time-budget=60000", f"--screenshot={path}",
        *(["--blink-settings=preferredColorScheme=0"] if dark else []), page.resolve().as_uri() + (f"#{season}" if season else ""),
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    if not path.is_file():
        sys.exit(f"Chromium drew nothing: {done.stderr[-2000:]}")


def covered(path, top=0, bottom=0):
    """Which pixels differ from the ground behind the tree, cut to these and brought to one size."""
    picture = Image.open(path).convert("RGBA")
    picture = picture.crop((0, top, picture.width, picture.height - bottom))
    pixels = numpy.asarray(picture, dtype=int)
    if pixels[0, 0, 3] == 0:
        mask = pixels[..., 3] > 127
    else:
        # What is even all round.
        mask = numpy.abs(pixels[..., :3] - pixels[:, :1, :3]).sum(axis=2) > 40
    rows, columns = numpy.flatnonzero(mask.any(axis=1)), numpy.flatnonzero(mask.any(axis=0))
    if len(rows) < 20 or len(columns) < 20:
        return None, 0
    cut = mask[rows[0]:rows[-1] + 1, columns[0]:columns[-1] + 1]
    image = Image.fromarray((cut * 255).astype(numpy.uint8)).resize((SIDE, SIDE), Image.Resampling.BOX)
    return numpy.asarray(image) > 100, cut.shape[1] / cut.shape[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("page", type=Path)
    parser.add_argument("preview", type=Path)
    parser.add_argument("--least", type=float, default=0.8)
    parser.add_argument("--dark", action="store_true")
    parser.add_argument("--season", help="the season that the page is opened in")
    parser.add_argument("--picture", type=Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        picture = arguments.picture or Path(folder) / "shot.png"
        # Virtual time does not wait for what is decoded on other threads: on a busy machine the picture may be taken before.
        for _ in range(5):
            shot(arguments.page, picture, arguments.dark, arguments.season)
            seen, wide = covered(picture, **BARS)
            if seen is not None:
                break
    told, told_wide = covered(arguments.preview)
    if seen is None or told is None:
        sys.exit(f"{arguments.page if seen is None else arguments.preview} shows nothing")
    both = (seen & told).sum() / (seen | told).sum()
    print(f"{arguments.page.name}: {both:.3f} of what is covered is the same, {wide:.3f} and {told_wide:.3f} times as wide as high")
    if both < arguments.least or abs(wide / told_wide - 1) > 0.15:
        sys.exit("the page shows something else than the preview")


if __name__ == "__main__":
    main()
