#!/bin/sh
# pkg_config.sh COMPILER PREFIX EXAMPLES OUTPUT: builds an example of each library with the flags of pkg-config, and runs the one that
# ends by itself.
set -eu
compiler=$1 prefix=$2 examples=$3 output=$4
PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name hertzline.pc)")
export PKG_CONFIG_PATH
mkdir -p "$output"

# shellcheck disable=SC2046  # lists of flags
"$compiler" "$examples/core/peak.cpp" $(pkg-config --cflags --libs hertzline-core) -o "$output/peak"
"$output/peak"
case " $(pkg-config --libs hertzline-core)" in
*" -lzmq"*) echo "hertzline-core asks for the dependencies of stream" >&2 && exit 1 ;;
esac
# shellcheck disable=SC2046
"$compiler" "$examples/stream/listen.cpp" $(pkg-config --cflags --libs hertzline) -o "$output/listen"
