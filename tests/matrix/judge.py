"""Compares what a program found in a file with what is in it. A cell: `reads` yes, part or no; what is `lost`, by aspect, with numbers."""

import importlib.util
from pathlib import Path

import numpy as np

spec = importlib.util.spec_from_file_location("page", Path(__file__).resolve().parents[1] / "render/html.py")
page = importlib.util.module_from_spec(spec)
spec.loader.exec_module(page)

# A picture is the same where so much of what either covers is covered by both, and colours differ by so little (of 255).
LEAST_COMMON = 0.9
MOST_COLOUR = 20
# A page and a preview look from other places at a sparse tree, which may sway. Other seasons have 0.1 to 0.2 in common.
LEAST_OF_PAGE = 0.45
LEAST_IN_WIND = 0.3
# Red is so much of red and green, give or take this: light of another colour changes it less than another season does.
MOST_REDNESS = 0.06


def cell(row, client, want, facts, shots, slug):
    if "error" in facts:
        said = [line for line in facts.get("said", []) if "rror" in line][:1]
        return {"reads": "no", "lost": {"file": "; ".join([facts["error"], *said])[:300]}}
    lost = {}
    if facts.get("messages"):
        lost["validator"] = f"{len(facts['messages'])}: {facts['messages'][0][:160]}"
    if not ("messages" in facts and "triangles" not in facts):
        lost |= dict(scene(row, want, facts))
        if "preview" in want:
            lost |= dict(beside_preview(Path(shots) / client["id"] / f"{slug(row['id'])}.png", want["preview"], facts))
        if client.get("looks") and "like" in row:
            lost |= dict(look(*(Path(shots) / client["id"] / f"{slug(name)}.png" for name in (row["id"], row["like"]))))
    return {"reads": "part", "lost": lost} if lost else {"reads": "yes"}


def scene(row, want, facts):
    """What of a scene, a skeleton or a table is lost: (aspect, numbers)."""
    for name in ("rows", "points", "edges", "triangles"):
        found = facts.get({"edges": "lines"}.get(name, name))
        if name in want and found is not None and found != want[name] or name in want and name not in ("points", "edges") and found is None:
            yield name, f"{found} of {want[name]}"
    if "recipe" in want and "rows" in want and "recipe" in facts and facts["recipe"] != want["recipe"]:
        yield "recipe", f"{facts['recipe']}"
    if "buttons" in want and facts["buttons"] != want["buttons"]:
        yield "buttons", f"{' '.join(facts['buttons'])} in place of {' '.join(want['buttons'])}"
    # Programs that leave joints to the graphics card have no box; their pictures are compared.
    if "shapes" not in row.get("holds", []) and "box" in want and not (facts["box"] is None and facts["joints"]):
        size = np.ptp(np.array(want["box"], dtype=float), axis=0).max()
        off = np.abs(np.array(facts["box"], dtype=float) - np.array(want["box"])).max() / size
        # Neither is one of what is no number.
        if not off < 2e-3:
            yield "box", f"{rounded(facts['box'])} in place of {rounded(want['box'])}"
    yield from materials(want.get("materials", {}), facts)
    for name in row.get("holds", []):
        if (fault := HOLDS[name.partition(":")[0]](name.partition(":")[2], want, facts)) is not None:
            yield name, fault


def rounded(box):
    return [[round(float("nan" if x is None else x), 3) for x in corner] for corner in box]


def materials(wanted, facts):
    if not wanted:
        return
    if "pictures" in facts:
        # No materials, but a list of pictures.
        count = sum(each["picture"] for each in wanted.values())
        if facts["pictures"] < count:
            yield "picture", f"{facts['pictures']} of {count}"
        return
    # Programs put numbers behind names.
    found = {name: next((each for other, each in facts["materials"].items() if other.removeprefix("mat_").startswith(name) and not other[len(name):].strip("._0123456789")), None)
             for name in sorted(wanted, key=len)}
    found |= {name: facts["materials"][name] for name in wanted if name in facts["materials"]}
    missing = [name for name in wanted if found[name] is None]
    if missing:
        yield "materials", f"without {', '.join(missing)}; has {', '.join(sorted(facts['materials']))[:120]}"
        return
    for aspect in ("picture", "normals", "cut", "two"):
        of = [name for name, each in wanted.items() if each[aspect]]
        without = [name for name in of if not found[name].get(aspect)]
        if without:
            yield aspect, f"not of {', '.join(without)}"


def names(facts):
    return [str(name).lower() for name in facts.get("nodes", [])]


def attributes(facts):
    return {str(name).lower().replace("_", "") for name in facts.get("attributes", [])}


def wind(_, want, facts):
    missing = {"wind", "windpivot"} - attributes(facts)
    return f"without {', '.join(sorted(missing))}" if missing else None


def packed(_, want, facts):
    found = attributes(facts)
    colour = any(name.startswith("col") for name in found)
    # TEXCOORD_1 and TEXCOORD_2, as each program calls them.
    sets = [name for name in found if name.startswith(("texcoord", "uv", "custom0")) ]
    return None if colour and len(sets) >= 3 - ("uv2" in found and "custom0" in found) else f"has {', '.join(sorted(facts.get('attributes', [])))[:120]}"


def covered(pairs, corners):
    """The area of triangles in a picture, each for itself, whichever way up they are."""
    a, b, c = np.array(pairs, dtype=float)[np.array(corners, dtype=int).reshape(-1, 3)].transpose(1, 2, 0)
    return float(np.abs((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]).sum() / 2)


def second(_, want, facts):
    """A pair for each vertex, in the picture, which covers as much of it as what was written."""
    if not facts.get("second"):
        return "none"
    area = 0.0
    for part in facts["second"]:
        pairs = np.array(part["pairs"], dtype=float).reshape(-1, 2)
        if len(pairs) != part["vertices"]:
            return f"{len(pairs)} for {part['vertices']} vertices"
        # Neither is what is no number.
        if not (np.abs(pairs - 0.5) < 0.5 + 1e-4).all():
            return f"from {pairs.min():.3f} to {pairs.max():.3f}"
        area += covered(pairs, part["corners"])
    return None if abs(area - want["second"]) < 1e-2 * want["second"] else f"{area:.3f} of {want['second']:.3f} covered"


def texels(_, want, facts):
    """As many different pairs as were written, each in the picture."""
    pairs = [pair for part in facts.get("second") or [] for pair in np.array(part["pairs"], dtype=float).reshape(-1, 2)]
    if not pairs:
        return "none"
    found = distinct(pairs)
    return None if found == want["texels"] else f"{found} of {want['texels']} pairs"


def distinct(pairs):
    """How many pairs differ by more than rounding; V may run up or down."""
    return len(np.unique(np.round(np.array(pairs), 3), axis=0))


def counted(key):
    def fault(_, want, facts):
        return None if facts.get(key, 0) == want[key] else f"{facts.get(key, 0)} of {want[key]}"
    return fault


def clip(_, want, facts):
    found = [each[0] for each in facts.get("clips", [])]
    return None if any("wind" in str(name).lower() for name in found) else f"has {found or 'none'}"[:120]


def named(key):
    def fault(_, want, facts):
        found = names(facts)
        missing = [name for name in want[key] if not any(name.lower() in other for other in found)]
        return f"without {', '.join(missing[:3])}" if missing else None
    return fault


def any_through(_, want, facts):
    return None if any(each.get("through") for each in facts.get("materials", {}).values()) else "no material has it"


def variants(name, want, facts):
    found = facts.get("variants") or {}
    return None if len(found.get(name, [])) > 1 else "one is seen"


def some(key):
    return lambda _, want, facts: None if facts.get(key) else "none"


HOLDS = {
    "wind": wind,
    "primvars": wind,
    "packed": packed,
    "second": second,
    "texels": texels,
    "morphs": counted("morphs"),
    "joints": counted("joints"),
    "clip": clip,
    "levels": lambda _, want, facts: None if facts.get("levels", 1) == want["levels"] else f"{facts.get('levels', 1)} of {want['levels']}",
    "siblings": named("siblings"),
    "shapes": named("shapes"),
    "bodies": lambda _, want, facts: None if facts.get("bodies", 0) == want["bodies"] else f"{facts.get('bodies', 0)} of {want['bodies']}",
    "through": any_through,
    "scene": lambda _, want, facts: None if facts.get("cameras") and facts.get("lights") else f"cameras {facts.get('cameras', 0)}, lights {facts.get('lights', 0)}",
    "variants": variants,
    "curves": some("curves"),
    "lines": some("lines"),
    "proxy": some("proxies"),
    "colours": lambda _, want, facts: None if any(name.startswith("col") for name in attributes(facts)) else "none",
}


def beside_preview(path, preview, facts):
    """How the picture of a page differs from one of `linden preview`; the numbers are noted in the facts."""
    seen, told = page.covered(path, **page.BARS)[0], page.covered(preview)[0]
    if seen is None:
        yield "look", "nothing is drawn"
        return
    facts["common"] = round(float((seen & told).sum() / (seen | told).sum()), 3)
    facts["redness"] = [round(float(each), 3) for each in (redness(path, **page.BARS), redness(preview))]
    if facts["common"] < (LEAST_IN_WIND if "Wind*" in facts["buttons"] else LEAST_OF_PAGE):
        yield "look", f"{facts['common']:.2f} in common with a preview"
    elif abs(np.subtract(*facts["redness"])) > MOST_REDNESS:
        yield "look", f"red is {facts['redness'][0]:.2f} of red and green, and {facts['redness'][1]:.2f} in a preview"


def redness(path, top=0, bottom=0):
    """The share of red in red and green of what differs from the ground."""
    from PIL import Image

    pixels = np.asarray(Image.open(path).convert("RGBA"), dtype=float)
    pixels = pixels[top:len(pixels) - bottom]
    is_tree = pixels[..., 3] > 127 if pixels[0, 0, 3] == 0 else np.abs(pixels[..., :3] - pixels[:, :1, :3]).sum(axis=2) > 40
    red, green = pixels[is_tree][:, :2].sum(axis=0)
    return red / (red + green)


def look(path, other):
    """How a picture differs from that of another row."""
    from PIL import Image

    if not (path.is_file() and other.is_file()):
        return
    first, second = (np.asarray(Image.open(each).convert("RGB"), dtype=int) for each in (path, other))
    covered = [np.abs(each - each[0, 0]).sum(axis=2) > 40 for each in (first, second)]
    both, either = covered[0] & covered[1], covered[0] | covered[1]
    if not both.any():
        yield "look", "nothing is drawn"
        return
    common = both.sum() / either.sum()
    colour = np.abs(first[both].mean(axis=0) - second[both].mean(axis=0)).max()
    if common < LEAST_COMMON:
        yield "look", f"{common:.2f} of the pixels in common"
    elif colour > MOST_COLOUR:
        yield "look", f"colours differ by {colour:.0f} of 255"
