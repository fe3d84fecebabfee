#!/usr/bin/env python3
"""Every PLY and STL file of a folder, by trimesh: one closed, consistently wound manifold that encloses a volume."""

import sys
from pathlib import Path

import numpy as np
import trimesh


def check(path):
    mesh = trimesh.load(path, process=False)
    # Vertices stand twice where bark pictures meet.
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    edges = mesh.edges_sorted.astype(np.int64)
    _, uses = np.unique(edges[:, 0] * len(mesh.vertices) + edges[:, 1], return_counts=True)
    boundary, crowded = (uses == 1).sum(), (uses > 2).sum()
    assert boundary == 0 and crowded == 0, f"{boundary} boundary edges, {crowded} non-manifold edges"
    assert mesh.is_watertight and mesh.is_winding_consistent and mesh.is_volume, "no volume"
    stems = int(path.stem.rsplit("_", 1)[1])
    # Each closed surface without handles counts 2; branches that touch make handles, and hollows.
    assert mesh.body_count >= 1 and mesh.euler_number % 2 == 0, f"Euler number {mesh.euler_number}"
    # One alone needs not be parted, which takes longer than all else.
    parts = mesh.split(only_watertight=True) if mesh.body_count > 1 else [mesh]
    outer = [part for part in parts if part.volume > 0]
    assert len(outer) <= stems, f"{len(outer)} solids for {stems} stems"
    print(f"{path.name}: {len(mesh.faces)} triangles, {mesh.volume:.4f} m3, Euler number {mesh.euler_number}")


failed = False
for path in sorted([*Path(sys.argv[1]).glob("*.ply"), *Path(sys.argv[1]).glob("*.stl")]):
    try:
        check(path)
    except AssertionError as error:
        failed = True
        print(f"{path.name}: {error}", file=sys.stderr)
sys.exit(failed)
