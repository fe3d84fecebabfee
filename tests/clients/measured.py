#!/usr/bin/env python3
"""The numbers of `report.json` of each folder, computed again from the files beside it: numpy and trimesh.

Lengths and topology from the table of cylinders (`tree.csv`); volumes and diameters of wood, crowns and leaves
from the mesh (`tree.glb`) and its pictures.
"""

import csv
import json
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np
import trimesh

TOLERANCE = 0.01
COLUMNS = ["parent", "branch", "start_radius_m", "branch_order", "position_in_branch", "length_m", "radius_m"]
COLUMNS += [f"start_{axis}_m" for axis in "xyz"] + [f"axis_{axis}" for axis in "xyz"]


def cylinders(path):
    with open(path) as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return [{key: float(value) for key, value in row.items() if key in COLUMNS} for row in rows]


def wood(rows, found):
    """Lengths, the cylinders' volume and the topology by walking down from the tips."""
    length = np.array([row["length_m"] for row in rows])
    radius = np.array([row["radius_m"] for row in rows])
    order = np.array([int(row["branch_order"]) for row in rows])
    found["total_length_m"] = length.sum()
    found["cylinder_volume_m3"] = (np.pi * radius**2 * length).sum()
    found["length_by_order_m"] = np.bincount(order, weights=length)

    start = np.array([[row[f"start_{axis}_m"] for axis in "xyz"] for row in rows])
    axis = np.array([[row[f"axis_{axis}"] for axis in "xyz"] for row in rows])
    end = start + axis * length[:, None]
    parent = np.array([int(row["parent"]) - 1 for row in rows])
    bears = set(parent)
    tips = [i for i in range(len(rows)) if i not in bears]
    # A lateral at the foot of a stem has no cylinder below, as a stem has none.
    path = np.zeros(len(rows))
    for i in range(len(rows)):
        path[i] = length[i] + (path[parent[i]] if parent[i] >= 0 else 0)
    found["tips"] = len(tips)
    found["path_length_mean_m"], found["path_length_longest_m"] = path[tips].mean(), path[tips].max()
    found["height_m"] = max(start[:, 1].max(), end[:, 1].max()) - min(start[:, 1].min(), end[:, 1].min())
    children = defaultdict(list)
    for i, p in enumerate(parent):
        children[p].append(i)
    strahler = np.zeros(len(rows), int)
    for i in reversed(range(len(rows))):
        above = sorted(strahler[child] for child in children[i])
        strahler[i] = 1 if not above else above[-1] + (len(above) > 1 and above[-2] == above[-1])
    goes_on = [parent[i] >= 0 and strahler[parent[i]] == strahler[i] for i in range(len(rows))]
    orders = range(1, strahler.max() + 1)
    counts = [sum(strahler[i] == o and not goes_on[i] for i in range(len(rows))) for o in orders]
    lengths = [length[strahler == o].sum() / count for o, count in zip(orders, counts)]
    found["strahler_order"], found["stream_counts"], found["stream_lengths_m"] = strahler.max(), counts, lengths
    if len(counts) > 1:
        found["bifurcation_ratio"] = np.exp(-np.polyfit(orders, np.log(counts), 1)[0])
        found["length_ratio"] = np.exp(np.polyfit(orders, np.log(lengths), 1)[0])
    # Laterals whose parent has a cylinder below; those at a foot are few, and left out where there are any.
    laterals = [i for i in range(len(rows)) if row_is_first(rows[i]) and parent[i] >= 0 and length[i] > 0 and length[parent[i]] > 0]
    stems = sum(order[i] == 0 and parent[i] < 0 for i in range(len(rows)))
    first = sum(parent < 0)
    if laterals and first == stems:
        angles = np.degrees(np.arccos([np.clip(axis[i] @ axis[parent[i]], -1, 1) for i in laterals]))
        found["branching_angle_mean_deg"] = angles.mean()
        of = order[laterals]
        found["branching_angle_by_order_deg"] = [angles[of == o].mean() for o in range(1, order.max() + 1)]
    return np.vstack([start, end])


def tubes(mesh, rows, found):
    """Volumes of the wood's mesh: each axis is a closed piece of it, in the order of the axes. Stems that lean go on into the
    ground, which is no wood of theirs."""
    corners, same = np.unique(mesh.vertices, axis=0, return_inverse=True)
    faces = same.reshape(-1)[mesh.faces]
    piece = trimesh.graph.connected_component_labels(
        np.vstack([faces[:, :2], faces[:, 1:]]), node_count=len(corners))[faces[:, 0]]
    foot = min(row["start_y_m"] for row in rows if row["branch_order"] == 0)
    corners = corners - [0, foot, 0]
    signed = of_cones(corners, faces)
    # A piece's first triangle says when it was written.
    _, first, number = np.unique(piece, return_index=True, return_inverse=True)
    order_of = {int(row["branch"]): int(row["branch_order"]) for row in rows}
    axes = sorted(order_of)
    is_known = len(first) == len(axes)
    orders = np.array([order_of[axis] for axis in axes])
    piece_of = np.argsort(np.argsort(first))[number.reshape(-1)]
    of_stems = faces[orders[piece_of] == 0] if is_known else faces
    # Without what closes it at the ground, which seen from there has no volume.
    above = trimesh.intersections.slice_faces_plane(corners, of_stems, plane_normal=[0, 1, 0], plane_origin=[0, 0, 0])
    in_ground = of_cones(corners, of_stems).sum() - of_cones(*above[:2]).sum()
    found["wood_volume_m3"] = signed.sum() - in_ground
    if is_known:
        volumes = np.bincount(orders, weights=np.bincount(piece_of, weights=signed))
        volumes[0] -= in_ground
        found["wood_volume_by_order_m3"] = volumes


def of_cones(corners, faces):
    """Signed volumes from the origin to each triangle."""
    a, b, c = (corners[faces[:, i]] for i in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)) / 6


def girth(mesh, rows, report, found):
    """The trunk's diameter: of the circle with the area of a cut through the mesh across the stem's course."""
    stems = [row for row in rows if row["branch_order"] == 0 and row["position_in_branch"] == 1]
    stem = max(stems, key=lambda row: row["start_radius_m"])["branch"]
    if report["dbh_m"] is None:
        return
    left = 1.3
    for row in (row for row in rows if row["branch"] == stem):
        if left <= row["length_m"]:
            break
        left -= row["length_m"]
    else:
        return
    start, along = (np.array([row[f"{name}_{axis}{unit}"] for axis in "xyz"]) for name, unit in [("start", "_m"), ("axis", "")])
    at = start + along * left
    cut = mesh.section(plane_origin=at, plane_normal=along)
    flat, back = cut.to_2D()
    middle = (np.linalg.inv(back) @ np.append(at, 1))[:2]
    # What else is cut are laterals, within the stem or far from it.
    loops = [loop for loop in flat.discrete if np.linalg.norm(loop[:-1].mean(axis=0) - middle) < 0.5 * report["dbh_m"]]
    areas = [abs(np.sum(p[:-1, 0] * p[1:, 1] - p[1:, 0] * p[:-1, 1])) / 2 for p in loops]
    found["dbh_m"] = found["trunk_diameter_m"] = 2 * np.sqrt(max(areas) / np.pi)


def row_is_first(row):
    return int(row["position_in_branch"]) == 1 and int(row["branch_order"]) > 0


def widths(points):
    """Widths by their definition: over directions, a quarter of a degree apart."""
    plan = points[:, [0, 2]]
    turns = np.radians(np.arange(0, 180, 0.25))
    across = plan @ np.array([np.cos(turns), np.sin(turns)])
    return np.ptp(across, axis=0)


def crown(points, suffix, found):
    over = widths(points)
    found[f"crown_width{suffix}_m"] = over.mean()
    found[f"crown_width_least{suffix}_m"] = over.min()
    found[f"crown_width_most{suffix}_m"] = over.max()


def hull_volume(points):
    try:
        return trimesh.convex.convex_hull(points).volume
    except Exception:  # in a plane
        return None


def plan_area(points):
    """Of the hull seen from above: a slab of it, one metre thick."""
    plan = points[:, [0, 2]]
    slab = np.vstack([np.column_stack([plan, np.zeros(len(plan))]), np.column_stack([plan, np.ones(len(plan))])])
    return hull_volume(slab)


def opaque_shares(mesh):
    """The opaque share of each triangle, by points spread over it: the nearest pixel's alpha."""
    material = getattr(mesh.visual, "material", None)
    if material is None or getattr(material, "alphaMode", None) != "MASK":
        return np.ones(len(mesh.faces))
    alpha = np.asarray(material.baseColorTexture.convert("RGBA"))[:, :, 3]
    height, width = alpha.shape
    uv = mesh.visual.uv[mesh.faces]
    # The rim of a leaf, up to which it is measured. Files cut farther out, so that leaves are seen from afar.
    rim = 0.5
    assert material.alphaCutoff is None or 0 < material.alphaCutoff <= rim
    # The same few triangles come again and again: those of each variant's mesh.
    keys, inverse = np.unique(uv.reshape(len(uv), 6).round(6), axis=0, return_inverse=True)
    n = 200
    i, j = np.meshgrid(np.arange(n), np.arange(n))
    inside = i + j < n
    a, b = (i[inside] + 1 / 3) / n, (j[inside] + 1 / 3) / n
    weights = np.column_stack([1 - a - b, a, b])
    shares = np.empty(len(keys))
    for k, key in enumerate(keys):
        at = weights @ key.reshape(3, 2)
        x = np.clip((at[:, 0] * width).astype(int), 0, width - 1)
        y = np.clip(((1 - at[:, 1]) * height).astype(int), 0, height - 1)
        shares[k] = (alpha[y, x] >= rim * 255).mean()
    return shares[inverse.reshape(-1)]


def leaves(scene, report, found):
    """Area, inclination, projection and layers of leaves: all meshes but the wood, blossom and fruit."""
    parts = [mesh for name, mesh in scene.geometry.items() if not name.endswith("_wood")]
    if not parts:
        return np.empty((0, 3))
    points = np.vstack([mesh.vertices for mesh in parts])
    if set(report["organ_kinds"]) & {"blossom", "fruit", "berry"}:
        return points
    areas, normals, middles = [], [], []
    for mesh in parts:
        a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
        normal = np.cross(b - a, c - a)
        double = np.linalg.norm(normal, axis=1)
        areas.append(double / 2 * opaque_shares(mesh))
        normals.append(normal / np.maximum(double, 1e-30)[:, None])
        middles.append((a + b + c) / 3)
    area, normal, middle = np.concatenate(areas), np.vstack(normals), np.vstack(middles)
    all_area, total = area, area.sum()
    found["leaf_area_m2"] = total
    # Numbers of leaf area count each leaf once, on however many sheets it is drawn. The test names these.
    sheets = report["_sheets"]
    assert set(report["sheets_by_kind"]) == {sheets}, report["sheets_by_kind"]
    found["leaf_area_once_m2"] = total / sheets
    if report["_first_is_blade"]:
        # Each leaf is its sheets, two triangles each.
        is_blade = np.arange(len(area)) // 2 % sheets == 0
        area, normal = area[is_blade], normal[is_blade]
        total = area.sum()
    upright = np.abs(normal[:, 1])
    inclination = np.degrees(np.arccos(np.clip(upright, 0, 1)))
    found["leaf_inclination_mean_deg"] = (inclination * area).sum() / total
    # G by its definition: the mean over the compass of |normal · direction|.
    turns = np.radians(np.arange(0, 360, 10) + 5)
    level = np.sqrt(np.maximum(0, 1 - upright**2))
    g = []
    for zenith in np.radians(np.arange(0, 91, 10)):
        seen = np.abs(upright[:, None] * np.cos(zenith) + level[:, None] * np.sin(zenith) * np.cos(turns)[None, :])
        g.append((seen.mean(axis=1) * area).sum() / total)
    found["g_function"] = g
    floor, layer = report["_floor_m"], report["leaf_layer_m"]
    by_layer = np.bincount(np.clip(((middle[:, 1] - floor) / layer).astype(int), 0, 9), weights=all_area, minlength=10)
    # One triangle on a border may fall either way: the sums of pairs are compared.
    found["_layers"] = by_layer / sheets
    return points


def compare(name, found, told):
    found, told = np.atleast_1d(np.asarray(found, float)), np.atleast_1d(np.asarray(told, float))
    assert found.shape == told.shape, f"{name}: {found} is not {told}"
    scale = max(np.abs(told).max(), 1e-9)
    off = np.abs(found - told).max() / scale
    assert off < TOLERANCE, f"{name}: {found}, told {told}"
    return off


def check(folder):
    report = json.loads((folder / "report.json").read_text())
    found = {}
    rows = cylinders(folder / "tree.csv")
    nodes = wood(rows, found)
    floor = report["_floor_m"] = nodes[:, 1].min()
    scene = trimesh.load(folder / "tree.glb", process=False)
    bark = next(mesh for name, mesh in scene.geometry.items() if name.endswith("_wood"))
    tubes(bark, rows, found)
    girth(bark, rows, report, found)
    points = leaves(scene, report, found)
    crown(nodes, "", found)
    found["crown_projection_m2"] = plan_area(nodes) or 0.0
    everything = np.vstack([nodes, points])
    crown(everything, "_with_leaves", found)
    found["crown_projection_with_leaves_m2"] = plan_area(everything) or 0.0
    found["height_with_leaves_m"] = everything[:, 1].max() - floor
    if report["crown_base_m"] is not None:
        base = report["crown_base_m"] + floor - 1e-6
        of_crown = nodes[nodes[:, 1] >= base]
        for name, some in [("crown_volume_m3", of_crown), ("crown_volume_with_leaves_m3", np.vstack([of_crown, points]))]:
            volume = hull_volume(some) if len(some) > 3 else 0.0
            if volume is not None:
                found[name] = volume
    layers = found.pop("_layers", None)
    if layers is not None:
        density = layers / (report["leaf_layer_m"] * found["crown_projection_with_leaves_m2"])
        found["leaf_area_density_m2_per_m3"] = density
        found["leaf_area_index"] = found["leaf_area_once_m2"] / found["crown_projection_with_leaves_m2"]
        assert abs(sum(report["leaf_inclination_shares"]) - 1) < 1e-9
    worst = max((compare(name, value, report[name]), name) for name, value in found.items())
    print(f"{folder.name}: {len(found)} numbers, {worst[1]} differs most, by {100 * worst[0]:.3f} %")


failed = False
for folder in sorted(path for path in Path(sys.argv[1]).iterdir() if path.is_dir()):
    try:
        check(folder)
    except AssertionError as error:
        failed = True
        print(f"{folder.name}: {error}", file=sys.stderr)
sys.exit(failed)
