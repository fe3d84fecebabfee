#!/usr/bin/env python3
"""Whether the program keeps to `--memory`: every command × preset × hostile knobs, as children whose peak
resident memory the system counts.

    tests/memory/limits.py                       # a sample: one case in 40
    tests/memory/limits.py --every 1             # all of them, for hours
    tests/memory/limits.py --linden target/release/linden --every 10

What the program, its threads and the allocator take beside the work is BASE_MIB and lies outside the limit, as
`linden --help` says. Exits with 1 where a peak is above limit + base, or where a child ends in another way than
0 (done) or 1 (refused, with a reason).
"""

import argparse
import hashlib
import json
import os
import pathlib
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import threading

# Everything is drawn here, and nothing of it kept in the folder of the user.
os.environ["LINDEN_CACHE"] = "off"

BASE_MIB = 32
LIMITS_MIB = [24, 48, 96, 256]
FORMATS = ["obj", "ply", "ply-skeleton", "qsm", "gltf", "glb", "usda", "usdz"]

# By generator; each a list of `--set`. What a preset does not have ends with 2 and does not count.
LSYSTEM = [
    ["derivations={+1}"],
    ["derivations={+3}"],
    ["derivations={+4}", "symbol_limit=1000000000"],
    ["derivations=10000", "symbol_limit=1000000000"],
    ["habit=shrub", "stems=100"],
    ["angle_jitter=20", "derivations={+2}"],
    ["segment_length=1000"],
]
COLONIZATION = [
    ["points=10000000"],
    ["points=100000000"],
    ["points=400000"],
    ["points=50000", "kill=1D", "influence=inf"],
    ["points=50000", "attraction=all"],
    ["points=20000", "step=0.002", "kill=1D"],
    ["age=0.5", "points=100000"],
]
ANY = [
    [],
    ["sides=128"],
    ["sides=128", "rings=32"],
    ["junction=watertight", "junction_detail=512"],
    ["junction=blend"],
    ["bark_size=4096"],
    ["leaf_size=4096"],
    ["leaves_per_m=1000", "leaf_max_radius=1"],
    ["leaf_form=curved", "leaves_per_m=300"],
    ["lods=8"],
    ["lods=4", "billboard=4", "billboard_size=4096"],
    ["triangles=4000000000"],
    ["triangles=5000", "lods=3"],
    ["wind=sway"],
    ["wind=bones", "bones=1024", "wind_frequency=0.05"],
    ["refine=subdivide subdivide subdivide subdivide subdivide subdivide"],
    ["refine=smooth relocate decimate"],
]


def commands(preset, sets, out):
    """Every command on a preset, as (name, arguments)."""
    knobs = [flag for own in sets for flag in ("--set", own)]
    yield "show", ["show", preset, *knobs]
    yield "stats", ["stats", preset, *knobs]
    for look in ["skeleton", "surface"]:
        yield f"preview {look}", ["preview", preset, "-o", f"{out}/a.png", "--look", look, *knobs]
    yield "preview 8000x8000", ["preview", preset, "-o", f"{out}/a.png", "--size", "8000x8000", *knobs]
    yield "sheet", ["sheet", preset, "-o", f"{out}/a.png", "--seeds", "4", *knobs]
    yield "sheet of 300", ["sheet", preset, "-o", f"{out}/a.png", "--seeds", "3", "--size", "3000x2000", *knobs]
    for name in FORMATS:
        yield f"export {name}", ["export", preset, "-o", f"{out}/a.{name}", "--format", name, *knobs]
    yield "export all", ["export", preset, *(f for n in FORMATS for f in ("-o", f"{out}/{n}.{n}")), "--format", ",".join(FORMATS), *knobs]
    yield "export seasons", ["export", preset, "-o", f"{out}/a.glb", "--seasons", *knobs]
    yield "export packed", ["export", preset, "-o", f"{out}/a.glb", "--set", "glb.compress=meshopt", "--set", "glb.instances=true", *knobs]
    yield "forest", ["forest", preset, "-o", f"{out}/a.glb", "--area", "40", *knobs]
    yield "forest compete", ["forest", preset, "-o", f"{out}/a.glb", "--area", "30", "--spacing", "6", "--compete", *knobs]


def cases(linden, out):
    """All cases: command, preset, knobs, arguments."""
    listed = json.loads(subprocess.run([linden, "list", "--json"], capture_output=True, check=True).stdout)
    for preset in listed:
        if preset["generator"] not in ("lsystem", "colonization"):
            continue
        of_generator, derivations = COLONIZATION, 0
        if preset["generator"] == "lsystem":
            shown = subprocess.run([linden, "show", preset["id"], "--json"], capture_output=True, check=True).stdout
            knobs = {knob["name"]: knob["value"] for knob in json.loads(shown)["knobs"]}
            of_generator, derivations = LSYSTEM, int(knobs["derivations"])
        for sets in of_generator + ANY:
            more = lambda found: str(derivations + int(found[1]))
            sets = [re.sub(r"\{\+(\d)\}", more, one) for one in sets]
            for name, arguments in commands(preset["id"], sets, out):
                yield name, preset["id"], " ".join(sets), arguments


def run(arguments, seconds):
    """Peak MiB, exit code (None: stopped after so many seconds), the last line of what it said."""
    child = subprocess.Popen(arguments, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL)
    stopped = []

    def stop():
        stopped.append(True)
        os.kill(child.pid, signal.SIGKILL)

    timer = threading.Timer(seconds, stop)
    timer.start()
    said = child.stderr.read().decode(errors="replace").strip()
    # Not Popen.wait: that forgets what the system counted.
    _, status, usage = os.wait4(child.pid, 0)
    timer.cancel()
    child.returncode = os.waitstatus_to_exitcode(status)
    code = None if stopped else child.returncode
    return usage.ru_maxrss / 1024, code, said.splitlines()[-1] if said else ""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    root = pathlib.Path(__file__).resolve().parents[2]
    parser.add_argument("--linden", default=str(root / "target/release/linden"))
    parser.add_argument("--every", type=int, default=40, help="run one case in so many")
    parser.add_argument("--first", type=int, default=0, help="another sample of the same size")
    parser.add_argument("--seconds", type=float, default=20, help="a child is stopped after so many")
    parser.add_argument("--only", default="", help="cases whose line holds this")
    chosen = parser.parse_args()

    worst, faults, times = {}, [], {}
    with tempfile.TemporaryDirectory() as out:
        for name, preset, knobs, arguments in cases(chosen.linden, out):
            line = f"{name} {preset} {knobs}"
            draw = int.from_bytes(hashlib.sha256(line.encode()).digest()[:4], "big")
            if draw % chosen.every != chosen.first % chosen.every or chosen.only not in line:
                continue
            limit = LIMITS_MIB[draw // chosen.every % len(LIMITS_MIB)]
            peak, code, said = run([chosen.linden, *arguments, "--memory", f"{limit}M"], chosen.seconds)
            for file in pathlib.Path(out).iterdir():
                file.unlink(missing_ok=True)
            if code == 2:
                continue
            share = (peak - BASE_MIB) / limit
            command = f"linden {shlex.join(arguments)} --memory {limit}M".replace(f"{out}/", "/tmp/")
            if share > 1:
                faults.append(f"{peak:.0f} MiB of {limit} + {BASE_MIB}: {command}")
            elif code not in (0, 1, None) or (code == 1 and not said):
                faults.append(f"ends with {code}: {command}: {said}")
            counts = times.setdefault(name, {})
            counts[code] = counts.get(code, 0) + 1
            if share > worst.get(name, (-1,))[0]:
                worst[name] = (share, peak, limit, preset, knobs)
            if share > 1 or code not in (0, 1, None):
                print(f"fault: {faults[-1]}", file=sys.stderr, flush=True)

    print(f"peak: resident MiB; share: (peak - {BASE_MIB} MiB) / limit; stopped: still at work after {chosen.seconds:.0f} s")
    print("| command | runs | done | refused | stopped | worst share | peak | limit | preset | knobs |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name, (share, peak, limit, preset, knobs) in sorted(worst.items(), key=lambda own: -own[1][0]):
        counts = times[name]
        done, refused, stopped = counts.get(0, 0), counts.get(1, 0), counts.get(None, 0)
        print(f"| {name} | {sum(counts.values())} | {done} | {refused} | {stopped} | {share:.2f} | {peak:.0f} | {limit} | {preset} | {knobs} |")
    for fault in faults:
        print(f"fault: {fault}")
    sys.exit(1 if faults or not worst else 0)


if __name__ == "__main__":
    main()
