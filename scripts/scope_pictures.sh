#!/bin/sh
# scope_pictures.sh [PROGRAM [FOLDER [--pace X]]]: takes screenshots of the scope's page on a running stream, in Chromium:
# docs/scope.png and docs/scope-dark-phone.png, and of an array docs/scope-array.png.
set -eu
cd "$(dirname "$0")/.."
program=$(realpath "${1:-build/release/hertzline}")
folder=$(realpath "${2:-docs}")
./scripts/install_packages.sh --tests
tests/clients/install_node_client.sh tests/scope build/node_scope
tests/clients/with_node_client.sh "$PWD/build/node_scope" node tests/scope/screenshots.mjs "$program" "$folder" ${3:+"$3" "$4"}
