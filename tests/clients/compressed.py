#!/usr/bin/env python3
"""Whether every glTF file X_packed of a directory holds, decoded, the bytes of X."""

import sys
from pathlib import Path

import numpy as np

import readers


def triangles(raw, width):
    """Each beginning with its smallest corner."""
    corners = np.frombuffer(raw, {2: "<u2", 4: "<u4"}[width]).reshape(-1, 3)
    first = corners.argmin(axis=1)
    return np.stack([corners[np.arange(len(corners)), (first + i) % 3] for i in range(3)], axis=1)


def main():
    packed_files = sorted(path for path in Path(sys.argv[1]).iterdir()
                          if path.stem.endswith("_packed") and path.suffix in (".glb", ".gltf"))
    assert packed_files, "nothing is packed"
    for path in packed_files:
        plain_path = path.with_stem(path.stem.removesuffix("_packed"))
        (plain, plain_bytes, _), (packed, packed_bytes, _) = map(readers.container, (plain_path, path))
        assert plain["accessors"] == packed["accessors"], "accessors differ"
        assert plain["nodes"] == packed["nodes"] and plain["meshes"] == packed["meshes"]
        views = zip(plain["bufferViews"], readers.views(plain, plain_bytes),
                    packed["bufferViews"], readers.views(packed, packed_bytes), strict=True)
        compressed = 0
        for index, (before, wanted, view, found) in enumerate(views):
            own = view.get("extensions", {}).get(readers.MESHOPT)
            compressed += own is not None
            assert before.get("byteStride") == view.get("byteStride")
            if own and own["mode"] == "TRIANGLES":
                width = own["byteStride"]
                assert (triangles(wanted, width) == triangles(found, width)).all(), f"{path.name}: view {index}"
            else:
                assert wanted == found, f"{path.name}: view {index} differs"
        assert compressed > 0 and len(packed_bytes) < len(plain_bytes)
        print(f"{path.name}: {compressed} views, {len(packed_bytes) / len(plain_bytes):.2f} of the size")


if __name__ == "__main__":
    main()
