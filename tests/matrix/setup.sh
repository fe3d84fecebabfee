#!/bin/sh
# Installs the programs of `run` into the build directory, once: tests/matrix/setup.sh
# Needs 3 GB, Python 3.11 (Blender's) with venv, Node.js 20 with npm, Chromium ($CHROMIUM or /usr/bin/chromium), and the network.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
fail() { echo "setup.sh: $1" >&2; exit 1; }

python=$(command -v python3.11) || fail "Blender as a Python module needs Python 3.11"
command -v npm >/dev/null || fail "npm is missing: install Node.js (20 or newer)"
[ -x "${CHROMIUM:-/usr/bin/chromium}" ] || fail "Chromium is missing (Debian: apt install chromium)"

target=$(cd "$here" && cargo metadata --format-version 1 --no-deps |
    python3 -c 'import json, sys; print(json.load(sys.stdin)["target_directory"])')
matrix=$target/matrix
mkdir -p "$matrix"
rm -f "$matrix/complete"

# NAME WORDS...: a place of its own for what pip installs by these words.
place() {
    name=$1
    shift
    [ -x "$matrix/$name/bin/python" ] || "$python" -m venv "$matrix/$name"
    "$matrix/$name/bin/python" -m pip install --quiet --disable-pip-version-check --no-cache-dir "$@" ||
        fail "pip could not install $* (see above)"
}
place venv -r "$here/requirements.txt"
place blender-4.5 bpy==4.5.15
place blender-5.0 bpy==5.0.1
# The last OpenUSD with the compliance checker that knows ARKit.
place arkit usd-core==25.5.1 numpy==2.4.6

cp "$here/package.json" "$here/package-lock.json" "$matrix/"
(cd "$matrix" && npm ci --silent --no-audit --no-fund --ignore-scripts --legacy-peer-deps) ||
    fail "npm could not install $here/package.json (see above)"
touch "$matrix/complete"
