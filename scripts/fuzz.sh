#!/bin/sh
# fuzz.sh [SECONDS] [TARGET...]: fuzzes each target of tests/fuzz (default: all) for SECONDS (default: 60) and prints a line for it.
# Exit status 1 when an input breaks a target's claims; build/fuzz/findings then has the input. build/fuzz/corpus keeps the inputs
# that a run has found; fuzz.sh --keep [TARGET...] copies the smallest part with the same coverage into tests/fuzz/corpus.
set -eu
cd "$(dirname "$0")/.."
command -v clang++ >/dev/null || { echo "fuzz.sh: needs Debian's clang and libclang-rt-14-dev" >&2; exit 1; }
seconds=60
case "${1:-}" in
--keep) seconds=keep && shift ;;
[0-9]*) seconds=$1 && shift ;;
esac
[ $# -gt 0 ] || set -- $(sed -n 's/^hertzline_fuzz(\([a-z0-9_]*\))/\1/p' tests/fuzz/CMakeLists.txt)
./scripts/build.sh fuzz

limits="-timeout=60 -rss_limit_mb=2048"
found=0
for target in "$@"; do
    export ASAN_OPTIONS= UBSAN_OPTIONS=print_stacktrace=1
    learnt=build/fuzz/corpus/$target
    findings=build/fuzz/findings/$target
    kept=tests/fuzz/corpus/$target
    log=build/fuzz/$target.log
    mkdir -p "$learnt" "$findings"
    if [ "$seconds" = keep ]; then
        rm -rf "$learnt.new" && mkdir -p "$learnt.new"
        # by edges, not by their counts: a hundred inputs instead of thousands
        build/fuzz/fuzz_"$target" -set_cover_merge=1 -use_counters=0 $limits "$learnt.new" "$kept" "$learnt" >"$log" 2>&1 ||
            { cat "$log" >&2; exit 1; }
        rm -rf "$kept" && mv "$learnt.new" "$kept"
        echo "$target: $(ls "$kept" | wc -l) inputs kept"
        continue
    fi
    dictionary=tests/fuzz/dictionaries/$target.dict
    case "$target" in scene_text | set_options)
        { cat "$dictionary" && build/fuzz/scene_words; } >build/fuzz/"$target".dict
        dictionary=build/fuzz/$target.dict ;;
    esac
    words=""
    [ ! -e "$dictionary" ] || words="-dict=$dictionary"
    build/fuzz/fuzz_"$target" -max_total_time="$seconds" $limits $words -print_final_stats=1 -artifact_prefix="$findings/" \
        "$learnt" "$kept" >"$log" 2>&1 || found=1
    awk -v target="$target" -v findings="$(ls "$findings" | wc -l)" '
        / cov: / { for (i = 1; i < NF; ++i) if ($i == "cov:") edges = $(i + 1) }
        /^stat::number_of_executed_units/ { runs = $2 }
        /^stat::average_exec_per_sec/ { rate = $2 }
        END { printf "%s: %d runs, %d a second, %d edges covered, %d findings\n", target, runs, rate, edges, findings }' "$log"
done
exit $found
