#!/bin/sh
# install_node_client.sh CLIENTS FOLDER: what the Node client needs, as CLIENTS/package-lock.json pins it, into
# FOLDER/node_modules. Quick when it is there already.
set -eu
cmp -s "$1/package-lock.json" "$2/installed.json" && exit 0
command -v npm >/dev/null || { echo "npm is missing: ./scripts/install_packages.sh --tests" >&2; exit 1; }
mkdir -p "$2"
cp "$1/package.json" "$1/package-lock.json" "$2"
# The package brings its compiled library along: nothing has to be built.
npm ci --prefix "$2" --ignore-scripts --no-audit --no-fund --prefer-offline
cp "$1/package-lock.json" "$2/installed.json"
