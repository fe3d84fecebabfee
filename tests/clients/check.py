#!/usr/bin/env python3
"""Checks every exported file of a directory with the clients that people have:

    target/clients/venv/bin/python tests/clients/check.py DIRECTORY

usd-core's and NVIDIA's validators, the Khronos glTF validator, trimesh; what all of those are blind
to (`geometry`); and across the files of one stem, whether they hold the same tree (`agreement`).
Prints a line per file and check; any error or warning makes the exit code 1.
"""

import io
import json
import logging
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections import defaultdict
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext, redirect_stderr, redirect_stdout
from itertools import repeat
from pathlib import Path

import numpy as np

import readers

HERE = Path(__file__).resolve().parent

# What NVIDIA's validator says of every file of ours that is no fault of the file, and why.
NVIDIA_ALLOWED = {
    # It wants binary files instead of text; text is what this format is for.
    "UsdAsciiPerformanceChecker",
    # Vertices along a seam share their place: they differ in their texture coordinates. Welding them
    # would take face-varying index arrays six times as long as what it saves.
    "WeldChecker",
}

def geometry(tree):
    """Faults of one file's arrays."""
    for file in tree.files:
        if not file.is_file():
            yield f"refers to {file.name}, which is not there"
    if tree.is_bare:
        if tree.recipe:
            yield "carries a recipe, which its format cannot"
    elif not tree.recipe:
        yield "carries no recipe"
    else:
        try:
            json.loads(tree.recipe)
        except ValueError as e:
            yield f"its recipe is no JSON: {e}"
    if not tree.meshes and tree.edges is None:
        yield "holds neither mesh nor skeleton"
    if tree.edges is not None:
        if not np.isfinite(tree.nodes).all():
            yield "a node is not finite"
        if (tree.nodes[:, 3] <= 0).any():
            yield "a radius is not above zero"
        if tree.edges.size and not (0 <= tree.edges.min() and tree.edges.max() < len(tree.nodes)):
            yield "an edge names a node that is not there"
    for mesh in tree.meshes + tree.around:
        yield from (f"{mesh.name}: {fault}" for fault in mesh_faults(mesh))


def mesh_faults(mesh):
    count = len(mesh.positions)
    if not count == len(mesh.normals) == len(mesh.uvs):
        yield f"{count} positions, {len(mesh.normals)} normals, {len(mesh.uvs)} texture coordinates"
        return
    for name, array in [("position", mesh.positions), ("normal", mesh.normals), ("uv", mesh.uvs)]:
        if not np.isfinite(array).all():
            yield f"a {name} is not finite"
            return
    if len(mesh.triangles) == 0:
        yield "no triangles"
        return
    if mesh.triangles.min() < 0 or mesh.triangles.max() >= count:
        yield "an index names a vertex that is not there"
        return
    used = np.zeros(count, bool)
    used[mesh.triangles] = True
    if not used.all():
        yield f"{(~used).sum()} vertices belong to no triangle"
    lengths = np.linalg.norm(mesh.normals, axis=1)
    if np.abs(lengths - 1).max() > 1e-4:
        yield f"a normal is {lengths[np.abs(lengths - 1).argmax()]} long"
    across = face_normals(mesh)
    mean = mesh.normals[mesh.triangles].sum(axis=1)
    against = (across * mean).sum(axis=1) < 0
    if against.any():
        yield f"{against.sum()} triangles wind against their normals"
    if mesh.bounds is not None:
        declared = np.array(mesh.bounds, dtype=np.float32)
        actual = np.array([mesh.positions.min(axis=0), mesh.positions.max(axis=0)], dtype=np.float32)
        if not (declared == actual).all():
            yield f"declares bounds {declared.tolist()}, has {actual.tolist()}"


def face_normals(mesh):
    """Twice the area of each triangle, along its normal."""
    a, b, c = (mesh.positions[mesh.triangles[:, i]] for i in range(3))
    return np.cross(b - a, c - a)


def agreement(trees):
    """Faults between the files of one tree: (path, fault)."""
    def measures(tree):
        meshes = tree.meshes
        slack = 2e-3 if tree.is_rounded else 1e-5
        area = sum(np.linalg.norm(face_normals(m), axis=1).sum() / 2 for m in meshes)
        # Where texture coordinates lie on the surface, weighted by area: catches a flipped V.
        textured = sum((np.linalg.norm(face_normals(m), axis=1)[:, None] *
                        m.uvs[m.triangles].mean(axis=1)).sum(axis=0) / 2 for m in meshes)
        low = np.min([m.positions.min(axis=0) for m in meshes], axis=0)
        high = np.max([m.positions.max(axis=0) for m in meshes], axis=0)
        numbers = np.array([area, *low, *high, *([] if tree.is_bare else textured)])
        return sum(len(m.triangles) for m in meshes), numbers, slack

    def common(numbers, others):
        # Texture stands last, where there is any.
        count = min(len(numbers), len(others))
        return numbers[:count], others[:count]

    meshed = [(path, measures(tree)) for path, tree in trees if tree.meshes]
    for path, (triangles, numbers, slack) in meshed[1:]:
        first, (first_triangles, first_numbers, first_slack) = meshed[0]
        slack = max(slack, first_slack)
        if triangles != first_triangles:
            yield path, f"{triangles} triangles, {first.name} has {first_triangles}"
        elif not np.allclose(*common(numbers, first_numbers), rtol=slack, atol=slack):
            yield path, f"area, texture or bounds {numbers.tolist()}, {first.name} has {first_numbers.tolist()}"
    recipes = [(path, json.loads(tree.recipe)) for path, tree in trees if not tree.is_bare]
    for path, recipe in recipes[1:]:
        if recipe != recipes[0][1]:
            yield path, f"another recipe than {recipes[0][0].name}"


def with_trimesh(path, tree):
    """Whether trimesh finds the same triangles, and the wood closed."""
    import trimesh

    if tree.edges is not None and not tree.meshes:
        loaded = trimesh.load(path)
        count = len(loaded.vertices)
        if count != len(tree.nodes):
            yield f"{count} vertices of {len(tree.nodes)} nodes"
        return
    if tree.is_instanced or tree.is_compressed:
        return  # it would show one of each, or nothing
    loaded = trimesh.load_scene(path, process=False)
    meshes = dict(loaded.geometry)
    placed = [meshes[loaded.graph[node][1]] for node in loaded.graph.nodes_geometry]
    found = sum(len(m.faces) for m in placed if hasattr(m, "faces"))
    expected = sum(len(m.triangles) for m in tree.meshes + tree.around) + tree.collider_triangles
    if found != expected:
        yield f"{found} triangles of {expected}"
    # Wood that has several barks is parted where they meet: each part is open there.
    is_parted = any("wood_" in name or "bark_" in name for name in meshes) or (
        path.suffix == ".ply" and b"comment part wood_" in path.read_bytes().partition(b"end_header")[0]
    )
    for name, mesh in meshes.items():
        if is_parted and ("wood" in name or "bark" in str(getattr(mesh.visual, "material", "")) or path.suffix in (".ply", ".obj")):
            continue
        # Leaves have an edge, ground and sky too.
        if not hasattr(mesh, "faces") or is_open(name + called(mesh)):
            continue
        # Wood and leaves are one mesh there, and nothing tells which is which; see solid.py.
        if path.suffix == ".stl":
            continue
        if not is_closed(mesh) and not (path.suffix == ".ply" and is_closed(of_first_part(path, mesh))):
            yield "the surface is open or inside out"


def called(mesh):
    """What its material is called, and shows."""
    material = getattr(mesh.visual, "material", None)
    return f"{getattr(material, 'name', '')} {material}"


def is_closed(mesh):
    mesh = mesh.copy()
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    # Not `is_watertight`: it wants exactly two triangles at an edge, and where a grammar draws two
    # branches at the very same place there are four, each pair of them closed.
    edges = mesh.edges.astype(np.int64)
    count = len(mesh.vertices)
    there, times = np.unique(edges[:, 0] * count + edges[:, 1], return_counts=True)
    back, times_back = np.unique(edges[:, 1] * count + edges[:, 0], return_counts=True)
    return np.array_equal(there, back) and np.array_equal(times, times_back) and mesh.volume > 0


def is_open(name):
    return any(part in name for part in ("leaves", "branches", "organs", "Ground", "Sky", "ground", "sky"))


def of_first_part(path, mesh):
    """The wood of a PLY, which has all parts in one mesh: wood comes first."""
    comment = next(line for line in path.read_bytes().split(b"\n") if line.startswith(b"comment part "))
    count = int(comment.split(b": ")[1].split()[0])
    return mesh.submesh([np.flatnonzero((mesh.faces < count).all(axis=1))], append=True, repair=False)


def with_usd_core(path):
    from pxr import Usd, UsdValidation

    stage = Usd.Stage.Open(str(path))
    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    for error in UsdValidation.ValidationContext(validators).Validate(stage):
        if is_materialx(error.GetMessage()):
            continue
        if error.GetType() in (UsdValidation.ValidationErrorType.Error, UsdValidation.ValidationErrorType.Warn):
            yield f"{error.GetName()}: {error.GetMessage()}"


def is_materialx(message):
    """Whether it is said of a node of MaterialX that no registry knows it: the wheel of usd-core is built without
    MaterialX. The exporter's tests check these nodes."""
    return re.search(r"shaderId 'ND_\w+' .* not found in sdrRegistry", message)


def has_joints(path):
    """Whether some mesh of a USD file is bound to joints."""
    from pxr import Usd

    stage = Usd.Stage.Open(str(path))
    # Trees of a forest are instances.
    prims = stage.Traverse(Usd.TraverseInstanceProxies())
    return any(prim.HasAttribute("primvars:skel:jointIndices") for prim in prims)


def with_nvidia(path):
    # Its command line, but within this process: to load it for each file would take most of the time.
    from usd_validation_nvidia import cli_main

    with tempfile.TemporaryDirectory() as directory:
        report = Path(directory) / "report.json"
        said = io.StringIO()
        logging.disable(logging.CRITICAL)
        try:
            with redirect_stdout(said), redirect_stderr(said):
                cli_main(["--json-output", str(report), str(path)])
        except SystemExit:
            pass  # it exits with 1 for anything that it has to say
        finally:
            logging.disable(logging.WARNING)
        if not report.is_file():
            yield f"nvidia_usd_validate gave no report: {said.getvalue().strip()[-500:]}"
            return
        for rule in json.loads(report.read_text())["rules"]:
            for issue in rule["issues"]:
                name = issue["rule"]["name"]
                if issue["severity"] != "INFO" and name not in NVIDIA_ALLOWED and not is_materialx(issue["message"]):
                    where = (issue["at"] or {}).get("path", "")
                    # Wood of several barks is parted where they meet.
                    if name == "ManifoldChecker" and "_wood_" in where:
                        continue
                    # It compares boxes to the last bit, which follow from turns of joints; bones.py compares them.
                    if name == "ExtentsChecker" and has_joints(path):
                        continue
                    yield f"{issue['severity']} {name}: {issue['message']} {where}"


def with_khronos(paths):
    """Faults by path."""
    clients = Path(sys.executable).parent.parent.parent
    # setup.sh puts one beside Python where the machine has none.
    node = shutil.which("node") or Path(sys.executable).with_name("node")
    command = [node, HERE / "gltf_validate.mjs", clients / "node_modules", *paths]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"the Khronos validator does not run: {done.stderr.strip()}; run {HERE / 'setup.sh'}")
    names = ["error", "warning"]  # then information and hints: unused texture coordinates, say
    return {
        Path(file): [f"{names[m['severity']]} {m['code']}: {m['message']} {m.get('pointer', '')}"
                     for m in issues["messages"] if m["severity"] < len(names)]
        for file, issues in json.loads(done.stdout).items()
    }


def check(directory, clients=True):
    """All faults of a directory: [(path, check, fault)], and [(path, check)] of what was fine."""
    paths = sorted(p for p in Path(directory).iterdir()
                   if p.suffix in (".obj", ".ply", ".gltf", ".glb", ".usda", ".usdc", ".usdz", ".stl")
                   # The second half of a file that is looked at with it.
                   and not p.stem.endswith("_payload"))
    if not paths:
        return [(Path(directory), "check", "holds no exported files")], []
    stems = defaultdict(list)
    for path in paths:
        stems[path.stem].append(path)
    faults, fine = [], []
    # Loading the clients takes a second: a process each is worth it for many trees only.
    with ProcessPoolExecutor(os.cpu_count()) if len(stems) > 8 else nullcontext() as pool:
        for more_faults, more_fine in (pool.map if pool else map)(check_stem, stems.values(), repeat(clients)):
            faults += more_faults
            fine += more_fine
    return faults, fine


def check_stem(paths, clients):
    """The same for the files of one stem."""
    faults, fine = [], []

    def note(path, name, found):
        found = list(found)
        faults.extend((path, name, fault) for fault in found)
        if not found:
            fine.append((path, name))

    def guarded(found):
        # A file that a reader stumbles over is at fault, not the program.
        try:
            yield from found
        except Exception as e:
            yield f"{type(e).__name__}: {e}"

    trees = {}
    for path in paths:
        try:
            trees[path] = readers.read(path)
        except Exception as e:
            faults.append((path, "geometry", f"{type(e).__name__}: {e}"))
            continue
        note(path, "geometry", guarded(geometry(trees[path])))
        if clients and path.suffix.startswith(".usd"):
            note(path, "usd-core", guarded(with_usd_core(path)))
            note(path, "nvidia", guarded(with_nvidia(path)))
        elif clients:
            note(path, "trimesh", guarded(with_trimesh(path, trees[path])))
    if clients and (of_khronos := [p for p in paths if p.suffix in (".gltf", ".glb")]):
        for path, found in with_khronos(of_khronos).items():
            note(path, "khronos", found)
    # What a file's own check has found would only be found again.
    if len(trees) > 1 and not any(path in trees for path, _, _ in faults):
        found = list(agreement(list(trees.items())))
        faults.extend((path, "agreement", fault) for path, fault in found)
        if not found:
            fine.append((paths[0].with_suffix(".*"), "agreement"))
    return faults, fine


def main():
    if len(sys.argv) != 2 or not Path(sys.argv[1]).is_dir():
        sys.exit(__doc__)
    logging.disable(logging.WARNING)
    faults, fine = check(sys.argv[1])
    for path, name in fine:
        print(f"ok     {path.name!r} {name}")
    for path, name, fault in faults:
        print(f"FAULT  {path.name!r} {name}: {fault}")
    print(f"{len(fine)} checks passed, {len(faults)} faults")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
