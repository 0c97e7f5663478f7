#!/usr/bin/env bash
# Checks style by clang-format on every source, which takes a second, and by clang-tidy.
#   lint.sh                   clang-tidy on everything: a quarter of an hour on two cores
#   lint.sh --changed [BASE]  clang-tidy on the ten sources that differ most from BASE (origin/main, or else the last commit): minutes
#   lint.sh --format          no clang-tidy
#   lint.sh --fix             formats
set -euo pipefail
cd "$(dirname "$0")/.."
mode=${1:-}
case "$mode" in
'' | --changed | --format | --fix) ;;
*) echo "lint.sh: found $mode, allowed: --changed, --format, --fix" >&2 && exit 2 ;;
esac
most_sources=10
sources_of_modules=({include,core,measures,recordings,studies,stream,scope,apps}/'*.'[ch]pp)

# Prints the commit to compare with; nothing in a clone of a single commit.
base_commit() { # [BASE]
    if [ -n "${1:-}" ]; then
        git merge-base "$1" HEAD
    elif base=$(git merge-base origin/main HEAD 2>/dev/null) && [ "$base" != "$(git rev-parse HEAD)" ]; then
        echo "$base"
    else
        git rev-parse --quiet --verify HEAD~1 || true
    fi
}

# Prints a source through which clang-tidy sees the file: itself, or for a header the source of that name, or one that includes it.
source_of() { # FILE
    case "$1" in *.cpp) echo "$1" && return ;; esac
    [ -f "${1%.hpp}.cpp" ] && echo "${1%.hpp}.cpp" && return
    for includer in $(git grep -lF "#include \"${1#include/}\"" -- "${sources_of_modules[@]}" | sort -t . -k 2); do
        source_of "$includer"
        return
    done
}

# Prints the changed sources, those with most changed lines first: a change of all names touches every source, and clang-tidy takes
# seconds for each.
changed_sources() { # COMMIT
    git diff --numstat --no-renames --diff-filter=d "$1" -- "${sources_of_modules[@]}" |
        awk '{ print $1 + $2, $3 }' | sort -k1,1nr -k2,2 |
        while read -r _ file; do source_of "$file"; done | awk '!seen[$0]++'
}

./scripts/install_packages.sh --tests
sources=$(git ls-files '*.cpp' '*.hpp')
if [ "$mode" = --fix ]; then
    echo "$sources" | xargs clang-format -i
    exit 0
fi
echo "clang-format ..." >&2
echo "$sources" | xargs clang-format --dry-run --Werror

case "$mode" in
--format) exit 0 ;;
--changed)
    base=$(base_commit "${2:-}")
    [ -n "$base" ] || { echo "no commit to compare with: no clang-tidy" >&2 && exit 0; }
    changed=$(changed_sources "$base")
    chosen=$(echo "$changed" | head -n "$most_sources")
    left=$(($(echo "$changed" | wc -l) - $(echo "$chosen" | wc -l)))
    [ "$left" -eq 0 ] || echo "clang-tidy leaves out $left changed sources: scripts/lint.sh checks all" >&2
    ;;
*) chosen=$(git ls-files "${sources_of_modules[@]}" | grep '\.cpp$') ;;
esac
[ -n "$chosen" ] || exit 0
echo "clang-tidy on $(echo "$chosen" | wc -l) sources ..." >&2
# the list of compile commands, of each source alone, and the generated header
mkdir -p build
if ! { cmake --preset release -B build/lint -DCMAKE_UNITY_BUILD=OFF -DHERTZLINE_TESTS=OFF -DHERTZLINE_BENCH=OFF &&
    cmake --build build/lint --target hertzline_git_hash; } >build/lint.log 2>&1; then
    cat build/lint.log >&2
    exit 1
fi
# g++'s warning options mean nothing to clang
echo "$chosen" | xargs -P "$(nproc)" -n 1 clang-tidy --quiet -p build/lint --extra-arg=-Wno-unknown-warning-option
