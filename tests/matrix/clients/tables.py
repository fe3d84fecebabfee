"""Opens tables with programs that read such: python tables.py < tasks.json"""

import json
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np


def table(path):
    """The columns of a table with names in its first line, which lines with # may come before."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    data = np.genfromtxt(lines, delimiter=",", names=True, dtype=None, encoding="utf-8")
    assert len(data.dtype.names) > 3, data.dtype.names
    return {"columns": data.dtype.names, "rows": data.size}


def mat(path):
    from scipy.io import loadmat

    found = loadmat(path, struct_as_record=False, squeeze_me=True)
    cylinder = found["QSM"].cylinder
    return {"rows": len(cylinder.radius), "columns": cylinder._fieldnames, "recipe": "linden_recipe" in found}


OPENERS = {".csv": table, ".mat": mat}


def main():
    print(json.dumps({"version": f"{version('numpy')}, {version('scipy')}"}))
    for task in json.load(sys.stdin):
        path = Path(task["root"]) / task["file"]
        try:
            told = OPENERS[path.suffix](path)
        except Exception as e:
            told = {"error": f"{type(e).__name__}: {e}".strip()[:300]}
        print(json.dumps({"row": task["row"], **told}, default=int), flush=True)


main()
