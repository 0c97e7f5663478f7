#!/bin/sh
# Installs the Debian packages of packages.txt that are missing. Quick and silent when none is.
# --optional installs those marked so, too.
set -eu
list="$(dirname "$0")/packages.txt"
marked='^optional '
[ "${1:-}" != --optional ] || marked='^$'
missing=""
for package in $(grep -v -e '^#' -e "$marked" "$list" | sed 's/^optional //'); do
    status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$status" = installed ] || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

as_root=""
if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "Missing packages:$missing. Install them as root, or install sudo." >&2; exit 1; }
    as_root=sudo
fi
echo "Installing:$missing" >&2
export DEBIAN_FRONTEND=noninteractive
$as_root apt-get update -qq
# shellcheck disable=SC2086  # a list of words
$as_root apt-get install -y -qq --no-install-recommends $missing >/dev/null
