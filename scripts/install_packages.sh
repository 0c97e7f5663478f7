#!/bin/sh
# install_packages.sh [--tests|--docs|--optional]: installs the missing Debian packages of packages.txt; with --tests also those for tests,
# with --docs those for the manual, with --optional all. Quick and silent when none is missing.
set -eu
passed_over="tests docs optional"
case "${1:-}" in
--tests) passed_over="docs optional" ;;
--docs) passed_over="tests optional" ;;
--optional) passed_over="" ;;
'') ;;
*) echo "install_packages.sh: found $1, allowed: --tests, --docs, --optional" >&2 && exit 2 ;;
esac

installed() { # PACKAGE [COMMAND]
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ] ||
        { [ -n "${2:-}" ] && command -v "$2" >/dev/null; }
}

missing=""
while read -r first second third; do
    case "$first" in
    '' | '#'*) continue ;;
    tests | docs | optional) mark=$first package=$second command=$third ;;
    *) mark="" package=$first command=$second ;;
    esac
    case " $passed_over " in *" ${mark:-always} "*) continue ;; esac
    installed "$package" "$command" || missing="$missing $package"
done <"$(dirname "$0")/packages.txt"
[ -n "$missing" ] || exit 0

as_root="env"
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "Missing packages:$missing. Install them as root, or install sudo." >&2; exit 1; }
    as_root="sudo env" # sudo passes no variables on
fi
echo "Installing:$missing" >&2
$as_root apt-get update -qq
# shellcheck disable=SC2086  # a list of words
$as_root DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
