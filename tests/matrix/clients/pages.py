"""Opens pages in Chromium, and compares them with previews (tests/render/html.py): python pages.py < tasks.json"""

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

spec = importlib.util.spec_from_file_location("page", Path(__file__).resolve().parents[2] / "render/html.py")
page = importlib.util.module_from_spec(spec)
spec.loader.exec_module(page)


def common(path, preview, picture):
    """What page and preview cover both, as a share of what either does."""
    for _ in range(5):
        page.shot(path, picture, False)
        seen, _ = page.covered(picture, **page.BARS)
        if seen is not None:
            break
    told, _ = page.covered(preview)
    return float((seen & told).sum() / (seen | told).sum())


def main():
    chromium = os.environ.get("CHROMIUM", "chromium")
    said = subprocess.run([chromium, "--version", "--no-sandbox"], capture_output=True, text=True, check=False).stdout
    print(json.dumps({"version": said.split()[1]}))
    for task in json.load(sys.stdin):
        try:
            told = {"common": common(Path(task["root"]) / task["file"], Path(task["preview"]), Path(task["shot"]))}
        except Exception as e:
            told = {"error": f"{type(e).__name__}: {e}"[:300]}
        print(json.dumps({"row": task["row"], **told}), flush=True)


main()
