"""Whether scipy finds the models of cylinders in a directory's MAT files: `mat.py DIRECTORY`, where each NAME.mat lies beside
NAME.txt, the same trees one after the other as TreeQSM's text."""

import sys
from pathlib import Path

import numpy
import scipy.io

# Columns of the text, and the fields that they are.
FIELDS = [("radius", 1), ("length", 1), ("start", 3), ("axis", 3), ("parent", 1), ("extension", 1), ("branch", 1),
          ("BranchOrder", 1), ("PositionInBranch", 1), ("mad", 1), ("SurfCov", 1), ("added", 1), ("UnmodRadius", 1)]


def main():
    files = sorted(Path(sys.argv[1]).glob("*.mat"))
    assert files, "no MAT file"
    for path in files:
        table = numpy.atleast_2d(numpy.loadtxt(path.with_suffix(".txt"), skiprows=1))
        content = scipy.io.loadmat(path)
        has_recipe = "linden_recipe" in content
        assert has_recipe == (not path.stem.startswith("bare")), path
        if has_recipe:
            assert str(content["linden_recipe"][0]).startswith("{"), content["linden_recipe"]
        models = content["QSM"]
        assert models.shape[0] == 1, models.shape
        first, branches = 0, 0
        for model in models[0]:
            cylinder = model["cylinder"][0, 0]
            rows = table[first:first + len(cylinder["radius"])]
            at = 0
            for name, width in FIELDS:
                found = cylinder[name].astype(float)
                expected = rows[:, at:at + width].copy()
                # Ids go on in the text, and begin again in each model.
                if name in ("parent", "extension"):
                    expected[expected > 0] -= first
                if name == "branch":
                    expected -= branches
                if name == "BranchOrder":
                    expected = numpy.minimum(expected, 255)
                # The text has the shortest digits of the same single.
                same = numpy.array_equal(found.astype(numpy.float32), expected.astype(numpy.float32))
                assert same, f"{path.name}: {name}"
                at += width
            assert cylinder["added"].dtype == numpy.uint8 or cylinder["added"].dtype == bool
            branches += int(cylinder["branch"].max())
            first += len(rows)
        assert first == len(table), (path.name, first, len(table))
        print(path.name, len(models[0]), "models,", first, "cylinders")


if __name__ == "__main__":
    main()
