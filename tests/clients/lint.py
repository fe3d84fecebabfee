"""Layers of text as usd-core writes them in binary, in each version that it knows: `lint.py DIRECTORY`.

`oak.usda` becomes `oak.0.8.usdc` and so on. The version is chosen once in a process: each has its own.
"""

import os
import subprocess
import sys
from pathlib import Path

VERSIONS = ["0.4.0", "0.5.0", "0.6.0", "0.7.0", "0.8.0", "0.9.0", "0.10.0", "0.13.0", "0.16.0"]


def convert(directory, version):
    from pxr import Sdf

    for text in sorted(Path(directory).glob("*.usda")):
        short = version.removesuffix(".0")
        binary = str(text.with_suffix(f".{short}.usdc"))
        assert Sdf.Layer.FindOrOpen(str(text)).Export(binary), binary
        head = open(binary, "rb").read(16)
        print(Path(binary).name, head[8:11])


def main():
    if len(sys.argv) > 2:
        convert(sys.argv[1], sys.argv[2])
        return
    for version in VERSIONS:
        env = dict(os.environ, USD_WRITE_NEW_USDC_FILES_AS_VERSION=version, PXR_USDC_EMIT_DEPRECATION_WARNINGS="0")
        subprocess.run([sys.executable, __file__, sys.argv[1], version], env=env, check=True)


main()
