"""What docs/impostors/viewer.html draws beside the plant itself: python impostor.py FOLDER CASES…

A case is NAME:YAW:PITCH:NEAR: NAME.json of `linden impostor` lies in the folder, and plant.glb, the same plant. A headless Chromium
($CHROMIUM, or one in the path) shows the viewer from there; the plant is drawn by the rasterizer below, which shares nothing with
linden's. Compared are the pixels that either covers, and the mean colour of those that both do. Broken shaders must fail.
$LINDEN_PICTURES names a file for all pictures, the viewer's above.
"""

import functools
import http.server
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import numpy as np
import trimesh
from PIL import Image

VIEWER = Path(__file__).resolve().parents[2] / "docs/impostors/viewer.html"
SIDE = 256
# What the viewer clears to, and the light of its shader.
GROUND = np.array([199, 212, 219])
LIGHT = np.array([0.5, 0.8, 0.4]) / np.linalg.norm([0.5, 0.8, 0.4])

# The least that viewer and plant must share of what either covers, and how far the mean of a colour may be away, of 255.
LEAST_SHARED = 0.87
MOST_AWAY = 20

# What is wrong with a shader, and how it is made so.
BREAKS = {
    "another frame": ("uv = (view + clamp(", "uv = (view.yx + clamp("),
    "mirrored": ("vec2(dot(spot, right)", "vec2(-dot(spot, right)"),
    "no depth": ("return (texture(normalDepth, uv).a * 2.0 - 1.0) * radius", "return 0.0"),
}


def camera(about, yaw, pitch, near):
    """Where the viewer's camera stands: its eye, its axes, and pixels from the middle at a distance of one."""
    yaw, pitch = np.radians([yaw, pitch])
    toward = np.array([np.cos(pitch) * np.sin(yaw), np.sin(pitch), np.cos(pitch) * np.cos(yaw)])
    right = np.cross([0, 1, 0], toward)
    right /= np.linalg.norm(right)
    eye = np.array(about["centre_m"]) + toward * near * about["radius_m"]
    # The sphere round all views takes all but a twentieth of the picture.
    return eye, np.array([right, np.cross(toward, right), toward]), SIDE / 2 / np.tan(np.arcsin(1.05 / near))


def drawn(plant, about, where):
    """The plant from there: what is covered, and sRGB colours as the viewer lights them."""
    eye, axes, focal = camera(about, *where)
    near, colors = np.zeros(SIDE * SIDE), np.zeros((SIDE * SIDE, 3))
    for mesh in plant:
        places = (mesh.vertices - eye) @ axes.T
        # Right, down and one over the distance: straight lines stay straight in all three.
        seen = np.stack([places[:, 0], -places[:, 1], np.ones(len(places))], axis=1) / -places[:, 2:]
        seen[:, :2] = seen[:, :2] * focal + SIDE / 2
        normals = mesh.vertex_normals
        texels = np.asarray(mesh.visual.material.baseColorTexture.convert("RGBA")) / 255
        corners = seen[mesh.faces]
        low = np.floor(corners[..., :2].min(axis=1)).astype(int)
        wide = np.floor(corners[..., :2].max(axis=1)).astype(int) - low + 1
        # Triangles with boxes of about one size at a time.
        sizes = 2 ** np.ceil(np.log2(wide.max(axis=1))).astype(int)
        for size in np.unique(sizes):
            of = np.flatnonzero(sizes == size)
            grid = np.stack(np.meshgrid(np.arange(size), np.arange(size)), axis=-1).reshape(1, -1, 2)
            at = low[of, None] + grid
            shares = barycentric(at + 0.5, corners[of, :, :2])
            face, cell = np.nonzero((shares >= 0).all(axis=2) & (at >= 0).all(axis=2) & (at < SIDE).all(axis=2))
            at, shares, own = at[face, cell], shares[face, cell], mesh.faces[of[face]]
            depth = (shares * seen[own, 2]).sum(axis=1)
            shares = shares * seen[own, 2] / depth[:, None]
            mixed = lambda values: np.einsum("pc,pcx->px", shares, values[own])
            # trimesh turns V up.
            u, v = (mixed(mesh.visual.uv) * [1, -1] % 1).T
            color = texels[(v * texels.shape[0]).astype(int) % texels.shape[0], (u * texels.shape[1]).astype(int) % texels.shape[1]]
            is_seen = color[:, 3] > 0.5
            pixel = (at[:, 1] * SIDE + at[:, 0])[is_seen]
            lit = shaded(color[is_seen, :3], mixed(normals)[is_seen], mixed(mesh.vertices)[is_seen] - eye)
            depth = depth[is_seen]
            # Of those of a pixel the last is the nearest.
            order = np.lexsort((depth, pixel))
            order = order[np.append(pixel[order][1:] != pixel[order][:-1], True)] if len(order) else order
            order = order[depth[order] > near[pixel[order]]]
            near[pixel[order]], colors[pixel[order]] = depth[order], lit[order]
    return (near > 0).reshape(SIDE, SIDE), colors.reshape(SIDE, SIDE, 3)


def barycentric(points, corners):
    """Shares of the three corners at points of each triangle; negative outside."""
    a, b, c = (corners[:, None, i] for i in range(3))
    cross = lambda u, v: u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    area = cross(b - a, c - a)
    area = np.where(area == 0, np.inf, area)
    of_a, of_b = cross(c - b, points - b) / area, cross(a - c, points - c) / area
    return np.stack([of_a, of_b, np.where(np.isinf(area), -1, 1 - of_a - of_b)], axis=2)


def shaded(color, normal, ray):
    """As the viewer's shader does it; leaves have two sides."""
    normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    normal = np.where((normal * ray).sum(axis=1, keepdims=True) > 0, -normal, normal)
    lit = 0.35 + 0.65 * np.maximum(normal @ LIGHT, 0) + 0.25 * np.maximum(normal[:, 1], 0)
    return np.minimum(color ** 2.2 * lit[:, None] * 1.4, 1) ** (1 / 2.2) * 255


class Served(http.server.SimpleHTTPRequestHandler):
    """The folder, the viewer, and what was done to it."""

    pages = {}

    def do_GET(self):
        page = self.pages.get(self.path[1:].split("?")[0])
        if page is None:
            super().do_GET()
            return
        self.send_response(200)
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.end_headers()
        self.wfile.write(page.encode())

    def log_message(self, *_):
        pass


def chromium():
    names = [os.environ.get("CHROMIUM"), "chromium", "chromium-browser", "google-chrome", "google-chrome-stable"]
    found = next(filter(None, map(shutil.which, filter(None, names))), None)
    return found or sys.exit("Chromium is missing: install it (Debian: apt install chromium), or name one in $CHROMIUM")


def shown(folder, queries):
    """What Chromium shows of these pages of the folder, all at once."""
    frames = "".join(f'<iframe src="{query}" width={SIDE} height={SIDE}></iframe>' for query in queries)
    Served.pages["all.html"] = f"<!doctype html><style>*{{margin:0;border:0;float:left}}</style>{frames}"
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Served, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    wide = SIDE * len(queries)
    with tempfile.TemporaryDirectory() as scratch:
        path = Path(scratch) / "shot.png"
        command = [
            chromium(), "--headless=new", "--no-sandbox", "--hide-scrollbars", "--use-gl=angle", "--use-angle=swiftshader",
            "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", f"--window-size={wide},{SIDE}", "--force-device-scale-factor=1",
            f"--user-data-dir={scratch}/user", "--virtual-time-budget=20000", f"--screenshot={path}",
            f"http://127.0.0.1:{server.server_port}/all.html",
        ]
        # Virtual time does not wait for what is decoded on other threads: on a busy machine the picture may be taken before.
        for _ in range(4):
            done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
            if not path.is_file():
                sys.exit(f"Chromium drew nothing: {done.stderr[-2000:]}")
            picture = np.asarray(Image.open(path).convert("RGB")).astype(int)
            views = np.split(picture[:SIDE, :wide], len(queries), axis=1)
            if all(covered(view).any() and (view[0, 0] == GROUND).all() for view in views):
                break
        server.shutdown()
        return views


def covered(view):
    return np.abs(view - GROUND).max(axis=2) > 2


def compared(view, plant):
    """Shared of what is covered, and how far the mean colour of that is away."""
    mask, colors = plant
    both = covered(view) & mask
    away = np.abs(view[both].mean(axis=0) - colors[both].mean(axis=0)).max() if both.any() else 255
    return both.sum() / (covered(view) | mask).sum(), away


def main():
    folder, cases = Path(sys.argv[1]), [case.split(":") for case in sys.argv[2:]]
    source = VIEWER.read_text(encoding="utf-8")
    Served.pages = {"viewer.html": source}
    queries = ["viewer.html?{}.json&yaw={}&pitch={}&near={}".format(*case) for case in cases]
    for number, (fault, (right, wrong)) in enumerate(BREAKS.items()):
        assert source.count(right) == 1, f"the shader has no such line any more, for {fault}: {right}"
        Served.pages[f"broken{number}.html"] = source.replace(right, wrong)
        queries.append(queries[0].replace("viewer", f"broken{number}"))
    views = shown(folder, queries)
    plant = trimesh.load(folder / "plant.glb").dump()
    faults, truths = [], []
    for (name, *where), view in zip(cases, views):
        about = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
        truths.append(drawn(plant, about, map(float, where)))
        shared, away = compared(view, truths[-1])
        print(f"{name} from {':'.join(where)}: {shared:.3f} of what is covered is the same, colours are {away:.1f} of 255 away")
        if shared < LEAST_SHARED or away > MOST_AWAY:
            faults.append(f"{name} from {':'.join(where)} shows something else than the plant")
    for fault, view in zip(BREAKS, views[len(cases):]):
        truths.append(truths[0])
        shared, _ = compared(view, truths[0])
        print(f"{fault}: {shared:.3f} of what is covered is the same")
        if shared >= LEAST_SHARED:
            faults.append(f"a shader that is broken ({fault}) passes")
    if os.environ.get("LINDEN_PICTURES"):
        below = [np.where(mask[..., None], colors, GROUND) for mask, colors in truths]
        both = np.concatenate([np.concatenate(views, axis=1), np.concatenate(below, axis=1)], axis=0)
        Image.fromarray(both.astype(np.uint8)).save(os.environ["LINDEN_PICTURES"])
    if faults:
        sys.exit("\n".join(faults))


if __name__ == "__main__":
    main()
