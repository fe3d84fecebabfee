#!/bin/sh
# Makes viewer.js.gz, which is in every page of the format `html`, out of viewer.mjs and three.js: exporters/html/viewer/bundle.sh
# Needs Node.js with npm, and the network. The bytes are the same wherever it runs: versions are those of package-lock.json.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$here/package.json" "$here/package-lock.json" "$here/viewer.mjs" "$work/"
cd "$work"
npm ci --silent --no-audit --no-fund
npm rebuild --silent esbuild
# three.js asks to keep its licence: what is bundled begins with it.
{ echo '/*! three.js 0.187.0, MIT, https://threejs.org'; sed 's/\*\///' node_modules/three/LICENSE; echo '*/'; } > licence.txt
npx esbuild viewer.mjs --bundle --minify --format=iife --target=es2022 --legal-comments=none --charset=utf8 --outfile=viewer.js
cat licence.txt viewer.js > whole.js
gzip -9 -n < whole.js > "$here/viewer.js.gz"
cp node_modules/three/LICENSE "$here/LICENSE-three"
ls -l "$here/viewer.js.gz"
