"""What has to arrive of a file, by plain readers (tests/clients/readers.py) and by `linden stats`: nothing here asks a program that is judged."""

import json
import subprocess
from pathlib import Path

import judge
import numpy as np
import readers


def of(row, path, twins):
    """Facts that a program has to find in the file of a row."""
    format = row["format"]
    if format in ("glb", "gltf"):
        want = gltf(path)
        # What is written in another way is the same tree.
        if not {"scene", "siblings", "shapes"} & set(row.get("holds", [])) and "file" not in row:
            twin = twins.of(row.get("plant", "tree"))
            assert want["triangles"] == twin["triangles"], (row["id"], want["triangles"], twin["triangles"])
            # Where joints carry vertices, these may be stored in any place.
            want["box"] = twins.of("tree")["box"] if want["joints"] else want["box"]
        return want
    if format in ("usda", "usdc", "usdz"):
        # Our reader of USD asks OpenUSD, which is judged itself: the same tree as glTF says what has to be there.
        shared = [f"--set=glb.{name}={value}" for name, value in row.get("set", {}).items() if name in ("pictures", "collision", "collision_most", "lightmap_uv")]
        return twins.of(row.get("plant", "tree"), (*row.get("with", []), *shared), row.get("twin"), has_sky=False)
    if format in ("obj", "ply", "stl"):
        tree = readers.read(path)
        want = measured(tree.meshes)
        twin = twins.of(row.get("plant", "tree"))
        assert want["triangles"] == twin["triangles"], row["id"]
        if format == "stl":
            want["box"] = z_up(want["box"])
        if format == "obj":
            has = row.get("set", {}).get("pictures") != "false"
            want["materials"] = {name: {**each, "two": None, "picture": each["picture"] and has, "normals": each["normals"] and has, "cut": each["cut"] and has}
                                 for name, each in twin["materials"].items()}
        return want
    if format == "3mf":
        twin = twins.of("tree")
        scale = 1000 / float(row.get("set", {}).get("scale", 100))
        return {"triangles": twin["triangles"], "box": (np.array(z_up(twin["box"])) * scale).tolist()}
    if format == "ply-skeleton":
        tree = readers.read(path)
        return {"points": len(tree.nodes), "edges": len(tree.edges)}
    if format in ("qsm", "mat", "organs"):
        said = twins.stats()
        return {"rows": said["organs"] if format == "organs" else said["segments"], "recipe": row.get("set", {}).get("recipe") != "false"}
    if format == "html":
        words = [*twins.plants[row.get("plant", "tree")], *row.get("with", [])]
        return {"preview": str(twins.preview(words, row.get("season"))), "buttons": buttons(words, row)}
    raise ValueError(f"nothing says what is expected of {format}")


def after(words, option):
    """The value of an option of the command line, as a list."""
    return words[words.index(option) + 1].split(",") if option in words else []


def buttons(words, row):
    """What can be pressed on a page of these words of the command line, and with a star what is."""
    seasons = after(words, "--seasons")
    levels = [] if row.get("set", {}).get("lods") == "files" else [f"LOD{level}" for level in range(len(after(words, "--lods")))]
    shown = {row.get("season", "summer").capitalize(), "LOD0"}
    moves = ["Wind*"] if {"--wind=sway", "--wind=bones"} & set(words) else []
    return ["Dark", "Turn", *moves, *(each + "*" * (each in shown) for each in [season.capitalize() for season in seasons] + levels)]


def z_up(box):
    (ax, ay, az), (bx, by, bz) = box
    return [[ax, -bz, ay], [bx, -az, by]]


def measured(meshes):
    corners = np.vstack([mesh.positions for mesh in meshes])
    return {"triangles": sum(len(mesh.triangles) for mesh in meshes), "box": [corners.min(axis=0).tolist(), corners.max(axis=0).tolist()]}


def gltf(path, has_sky=True):
    tree = readers.read(path)
    document, _, _ = readers.container(path)
    want = measured(tree.meshes + [mesh for mesh in tree.around if has_sky or "sky" not in mesh.name.lower()])
    want["triangles"] += tree.collider_triangles
    nodes, meshes = document["nodes"], document["meshes"]
    shown, seen = list(document["scenes"][0]["nodes"]), []
    while shown:
        seen.append(nodes[shown.pop()])
        shown += seen[-1].get("children", [])
    parts = [part for node in seen if "mesh" in node for part in meshes[node["mesh"]]["primitives"]]
    want["materials"] = {}
    for part in parts:
        if "material" in part and (has_sky or document["materials"][part["material"]]["name"] != "sky"):
            material = document["materials"][part["material"]]
            want["materials"][material["name"]] = {
                "picture": "baseColorTexture" in material.get("pbrMetallicRoughness", {}), "normals": "normalTexture" in material,
                "cut": material.get("alphaMode") == "MASK", "two": material.get("doubleSided", False),
            }
    # How much of a picture the second texture coordinates cover.
    want["second"] = sum(judge.covered(mesh.second, mesh.triangles) for mesh in tree.meshes if mesh.second is not None)
    seconds = [mesh.second for mesh in tree.meshes if mesh.second is not None]
    want["texels"] = judge.distinct(np.vstack(seconds)) if seconds else 0
    want["morphs"] = max(len(part.get("targets", [])) for part in parts)
    want["joints"] = sum(len(skin["joints"]) for skin in document.get("skins", []))
    want["levels"] = 1 + max((len(node.get("extensions", {}).get("MSFT_lod", {}).get("ids", [])) for node in nodes), default=0)
    names = [node.get("name", "") for node in seen]
    want["siblings"] = [name for name in names if "_LOD" in name]
    want["shapes"] = [name for name in names if name.startswith("UCX_") or name.endswith("-convcolonly")]
    want["bodies"] = sum("collider" in node.get("extensions", {}).get("OMI_physics_body", {}) for node in nodes)
    return want


class Twins:
    """Each plant once as a plain GLB, by which files of other formats are measured."""

    def __init__(self, linden, plants, directory):
        self.linden, self.plants, self.directory, self.known = linden, plants, directory, {}
        self.previews = []
        directory.mkdir(parents=True, exist_ok=True)

    def run(self, *words):
        done = subprocess.run([self.linden, *words], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    def of(self, plant, words=(), named=None, has_sky=True):
        """Facts of a plant's GLB; of seasons and ages, which have a file each, of the named one, or of the first."""
        key = (plant, words, named, has_sky)
        if key not in self.known:
            path = self.directory / f"{plant}{len(self.known)}.glb"
            self.run(*self.plants[plant], *words, "-o", path)
            if not path.is_file():
                files = sorted(self.directory.glob(f"{path.stem}_*.glb"), key=lambda file: file.stat().st_mtime_ns)
                path = next(file for file in files if not named or file.stem == f"{path.stem}_{named}")
            self.known[key] = gltf(path, has_sky)
            if plant == "tree" and not words:
                said = json.loads(self.run("stats", *self.plants[plant][1:], "--json"))
                assert said["triangles"] == self.known[key]["triangles"], "linden stats counts other triangles"
        return self.known[key]

    def stats(self):
        said = json.loads(self.run("stats", self.plants["tree"][1], "--json"))
        thinned = json.loads(self.run("stats", *self.plants["tree"][1:], "--json"))
        return {"segments": said["segments"], "organs": thinned["leaves"]}

    def preview(self, words, season):
        """What a plant of these words of `linden export` looks like in a season, at its finest level."""
        levels = after(words, "--lods")
        dropped = {each for option in ("--seasons", "--lods") if option in words for each in (option, words[words.index(option) + 1])}
        kept = [each for each in words[1:] if each not in dropped and not each.startswith("--wind")]
        kept += ["--triangles", levels[0]] if levels else []
        # Seasons by their names are those of the knob.
        kept += [f"--set=season={season or 'summer'}"] if "--seasons" in words else []
        if kept not in self.previews:
            path = self.directory / f"preview{len(self.previews)}.png"
            self.run("preview", *kept, "--background", "transparent", "-o", path)
            self.previews.append(kept)
        return self.directory / f"preview{self.previews.index(kept)}.png"
