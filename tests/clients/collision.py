"""Shapes for physics in GLB files, beside the wood and the crown that they stand for:

    target/clients/venv/bin/python tests/clients/collision.py DIRECTORY

`NAME_capsules.glb` has capsules, `NAME_hull.glb` the crown's hull too, each by names or by extensions.
"""

import json
import struct
import sys
from pathlib import Path

import numpy as np
import trimesh


def document(path):
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20:20 + length])


def shapes(path):
    """Volumes of capsules and of hulls."""
    gltf = document(path)
    scene = trimesh.load_scene(path, process=False)
    told = gltf.get("extensions", {}).get("OMI_physics_shape", {}).get("shapes", [])
    capsules, hulls = [], []
    for node in gltf["nodes"]:
        body = node.get("extensions", {}).get("OMI_physics_body", {})
        if "collider" in body:
            shape = told[body["collider"]["shape"]]
            if shape["type"] == "capsule":
                sizes = shape["capsule"]
                assert sizes["radiusTop"] == sizes["radiusBottom"]
                capsules.append(trimesh.creation.capsule(sizes["height"], sizes["radiusTop"]).volume)
            else:
                points = gltf["meshes"][shape["convex"]["mesh"]]["primitives"][0]["attributes"]["POSITION"]
                box = gltf["accessors"][points]
                hulls.append(np.prod(np.subtract(box["max"], box["min"])))
        elif node["name"].startswith("UCX_") or node["name"].endswith("-convcolonly"):
            mesh = next(m for name, m in scene.geometry.items() if name == gltf["meshes"][node["mesh"]]["name"])
            assert mesh.is_watertight and mesh.is_convex, f"{node['name']} is not convex"
            (hulls if len(mesh.vertices) != 34 else capsules).append(mesh.volume)
    return capsules, hulls, scene


def check(path):
    capsules, hulls, scene = shapes(path)
    wood = next(m for name, m in scene.geometry.items() if name.endswith("_wood"))
    assert len(capsules) + len(hulls) <= 64, f"{len(capsules)} capsules"
    # Overlapping round ends make them larger, twigs are left out: an order of size, told exactly by exporters/collision.
    assert 0.4 * wood.volume < sum(capsules) < 2.5 * wood.volume, f"{sum(capsules)} of {wood.volume} m3"
    if "hull" in path.stem:
        assert len(hulls) == 1
        box = np.prod(scene.extents)
        assert 0.2 * box < hulls[0] < 1.05 * box, f"{hulls} of a box of {box}"
    print(f"{path.name}: {len(capsules)} capsules of {sum(capsules):.3f} m3, wood {wood.volume:.3f} m3, hulls {hulls}")


if __name__ == "__main__":
    for file in sorted(Path(sys.argv[1]).glob("*.glb")):
        try:
            check(file)
        except AssertionError as error:
            sys.exit(f"{file.name}: {error}")
