#!/bin/sh
# docs.sh [OUT]: builds the manual as HTML with a search, from the Markdown documents and the public headers: build/manual/index.html.
# Broken links and other warnings are errors. Needs no network, and the same sources give the same bytes. Sphinx with MyST and Breathe
# is the one generator of Debian 12 that checks anchors in Markdown, documents C++, and searches without a server.
# Exits with 77 where packages are missing.
set -eu
cd "$(dirname "$0")/.."
out=$(realpath -m "${1:-build/manual}")
if ! command -v doxygen >/dev/null || ! /usr/bin/python3 -c 'import breathe, myst_parser, sphinx, sphinx_rtd_theme' 2>/dev/null; then
    echo "Doxygen, Sphinx or one of its extensions is missing: scripts/install_packages.sh --docs installs them" >&2
    exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The sources: the project without builds, packages and files that git ignores, and a page of all headers.
mkdir "$work/source"
ln -s "$PWD"/* "$PWD/docs/manual/index.rst" "$work/source"
rm -f "$work/source/build" "$work/source/debian" "$work/source"/obj-*
{ git check-ignore -- * 2>/dev/null || true; } | while read -r ignored; do rm -f "$work/source/$ignored"; done
{
    printf 'Headers\n=======\n\nAll names lie in the namespace ``hertzline``.\n'
    for header in include/hertzline/*.hpp; do
        name="<${header#include/}>"
        printf '\n%s\n%s\n\n.. doxygenfile:: %s\n' "$name" "$(echo "$name" | tr -c '\n' -)" "${header#include/}"
    done
} >"$work/source/headers.rst"

export HERTZLINE_MANUAL="$work"
(cd include && doxygen ../docs/manual/Doxyfile)
# Several processes, or another order of sets, would give other bytes.
PYTHONHASHSEED=0 /usr/bin/python3 -B -m sphinx -q -W --keep-going -c docs/manual -d "$work/doctrees" "$work/source" "$out"
rm -f "$out/.buildinfo" "$out/objects.inv"
