"""Compares layers of text with those in binary: `crates.py DIRECTORY`, in which both lie side by side.

All specs, all their fields, arrays to the bit; and what usd-core makes of both as text.
"""

import struct
import sys
from pathlib import Path

from pxr import Sdf, Usd, Vt


def fields(layer):
    found = {}

    def visit(path):
        spec = layer.GetObjectAtPath(path)
        if spec is None:
            return
        found[str(path)] = {key: spec.GetInfo(key) for key in spec.ListInfoKeys()}

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    return found


def bits(value):
    """Arrays as bytes, all else as it is written."""
    if type(value).__module__.endswith("Vt"):
        try:
            return (type(value).__name__, len(value), bytes(memoryview(value)))
        except TypeError:
            return (type(value).__name__, [str(item) for item in value])
    if isinstance(value, float):
        return struct.pack("<d", value)
    return str(value)


def main():
    compared = arrays = 0
    binaries = sorted(Path(sys.argv[1]).glob("*.usdc"))
    assert binaries, "there is nothing to compare"
    for binary in map(str, binaries):
        text = binary.removesuffix("c") + "a"
        assert open(binary, "rb").read(8) == b"PXR-USDC", binary
        one, other = Sdf.Layer.FindOrOpen(text), Sdf.Layer.FindOrOpen(binary)
        a, b = fields(one), fields(other)
        assert a.keys() == b.keys(), (binary, sorted(a.keys() ^ b.keys())[:9])
        for path in a:
            assert a[path].keys() == b[path].keys(), (binary, path, a[path].keys() ^ b[path].keys())
            for key in a[path]:
                same = bits(a[path][key]) == bits(b[path][key])
                assert same, (binary, path, key, str(a[path][key])[:200], str(b[path][key])[:200])
                compared += 1
                arrays += type(a[path][key]).__module__.endswith("Vt")
        assert one.ExportToString() == other.ExportToString(), binary
        stage = Usd.Stage.Open(binary)
        assert stage.GetDefaultPrim(), binary
        assert not stage.GetCompositionErrors(), binary
    assert arrays, "no array was compared"
    print(f"{compared} fields, {arrays} arrays")


main()
