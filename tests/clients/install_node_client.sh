#!/bin/sh
# install_node_client.sh CLIENTS FOLDER: installs the Node client's dependencies, pinned by CLIENTS/package-lock.json, into
# FOLDER/node_modules. Quick when they are there already. Where npm's registry cannot be reached it prints so and ends with status 77.
set -eu
cmp -s "$1/package-lock.json" "$2/installed.json" && exit 0
command -v npm >/dev/null || { echo "npm is missing: ./scripts/install_packages.sh --tests" >&2; exit 1; }
mkdir -p "$2"
rm -f "$2/installed.json"
cp "$1/package.json" "$1/package-lock.json" "$2"
# The package includes its compiled library: nothing has to be built.
if ! npm ci --prefix "$2" --ignore-scripts --no-audit --no-fund --prefer-offline \
    --fetch-retries 1 --fetch-retry-mintimeout 1000 --fetch-timeout 30000 >"$2/npm.log" 2>&1; then
    cat "$2/npm.log" >&2
    unreachable='E(CONNREFUSED|CONNRESET|NOTFOUND|AI_AGAIN|TIMEDOUT|NETUNREACH|HOSTUNREACH)|ERR_SOCKET_TIMEOUT'
    grep -qE "code ($unreachable)" "$2/npm.log" || exit 1
    echo "skipped: npm's registry cannot be reached ($(npm config get registry))"
    exit 77
fi
cp "$1/package-lock.json" "$2/installed.json"
