#!/bin/sh
# with_node_client.sh FOLDER COMMAND...: runs the command, unless install_node_client.sh could not reach npm's registry.
set -eu
folder=$1
shift
[ -f "$folder/installed.json" ] || { echo "skipped: the Node client is not installed, see clients/node_install"; exit 77; }
NODE_PATH=$folder/node_modules exec "$@"
