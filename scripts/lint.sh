#!/bin/sh
# Checks style. lint.sh: clang-format and clang-tidy (a quarter of an hour on two cores); lint.sh --format: the format alone;
# lint.sh --fix: formats.
set -eu
cd "$(dirname "$0")/.."
./scripts/install_packages.sh --tests
sources=$(git ls-files '*.cpp' '*.hpp')
if [ "${1:-}" = --fix ]; then
    echo "$sources" | xargs clang-format -i
    exit 0
fi
echo "clang-format ..." >&2
echo "$sources" | xargs clang-format --dry-run --Werror
[ "${1:-}" = --format ] && exit 0
echo "clang-tidy ..." >&2
./scripts/build.sh release  # generated sources and the list of compile commands
# g++'s warning options mean nothing to clang
git ls-files 'core/*.cpp' 'stream/*.cpp' 'apps/*.cpp' |
    xargs -P "$(nproc)" -n 1 clang-tidy --quiet -p build/release --extra-arg=-Wno-unknown-warning-option
