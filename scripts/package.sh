#!/usr/bin/env bash
# Debian packages of the last commit.
#   package.sh [FOLDER]                 builds them in an exported tree, into FOLDER (build/packages), and checks them by lintian
#   package.sh --reproducible [FOLDER]  builds them again elsewhere, in another time zone and language, and compares them byte by byte
#   package.sh --archive [FOLDER]       makes a tar.gz of the program in FOLDER with its libraries, for an x86-64 Linux with glibc 2.36 or newer
#   package.sh --try [FOLDER]           tries what is in FOLDER in fresh systems, which it downloads, as root: the archive in Debian 12 and
#                                       13; the packages in Debian 12: installation, debian/tests, upgrade, purge
# Needs what debian/control builds with (apt build-dep .) and lintian; for the modes locales, patchelf or debootstrap.
set -euo pipefail
umask 022 # the modes of files are part of the bytes
cd "$(dirname "$0")/.."
mode=build
case "${1:-}" in --*) mode=${1#--} && shift ;; esac
folder=${1:-build/packages}
mkdir -p "$folder"
folder=$(realpath "$folder")
work=$(mktemp -d "${TMPDIR:-/tmp}/hertzline-packages-XXXXXX")
trap 'rm -rf --one-file-system "$work"' EXIT

fail() {
    echo "package.sh: $*" >&2
    exit 1
}

need() { # PROGRAM-OR-FILE PACKAGE
    [ -e "$1" ] || PATH=$PATH:/usr/sbin command -v "$1" >/dev/null || fail "needs Debian's $2"
}

build() { # FOLDER [NAME=VALUE...]: builds the last commit there, and leaves the packages in it
    mkdir -p "$1/tree"
    git archive HEAD | tar -x --no-same-permissions -C "$1/tree"
    echo "Building the packages of $(git rev-parse --short HEAD) ..." >&2
    # the date of every file
    date=SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
    if ! (cd "$1/tree" && env "$date" "${@:2}" dpkg-buildpackage -us -uc) >"$1/log" 2>&1; then
        tail -n 50 "$1/log" >&2
        fail "the build has failed"
    fi
    rm -r "$1/tree"
}

make_archive() {
    dpkg-deb -x "$(echo "$folder"/hertzline_*.deb)" "$work/package"
    name=hertzline-$(dpkg-deb -f "$folder"/hertzline_*.deb Version)-$(uname -m)
    archive=$work/$name documents=$work/$name/share/doc/hertzline
    mkdir -p "$archive"/{bin,lib} "$documents/libraries"
    cp "$work/package/usr/bin/hertzline" "$archive/bin"
    cp -r "$work"/package/usr/share/{hertzline,man,bash-completion,zsh,fish} "$archive/share"
    cp LICENSING.md "$documents"
    loaded=$(debian/loaded_libraries.sh "$archive/bin")
    # shellcheck disable=SC2086  # a list of words
    for library in $loaded $(ldd "$archive/bin/hertzline" $loaded | sed -n 's/.* => \(\/[^ ]*\) .*/\1/p' | sort -u); do
        file=$(realpath "$library") # dpkg may know it in /lib, which is /usr/lib
        package=$(dpkg-query --search "*/$(dpkg-architecture -qDEB_HOST_MULTIARCH)/${file##*/}" | cut -d : -f 1)
        [ "$package" != libc6 ] || continue # each Linux has its own, which must be as new
        cp --dereference "$library" "$archive/lib"
        cp "/usr/share/doc/$package/copyright" "$documents/libraries/$package"
    done
    while read -r package; do
        cp "/usr/share/doc/$package/copyright" "$documents/libraries/$package"
    done <debian/compiled_in
    # The texts that the notices name are part of Debian alone.
    mkdir "$documents/common-licenses"
    grep -rhoE '/usr/share/common-licenses/[A-Z][A-Za-z0-9.-]*[A-Za-z0-9]' "$documents/libraries" | sort -u |
        xargs cp -t "$documents/common-licenses"
    (cd "$documents/libraries" && dpkg-query -W -f '${Package}: source ${source:Package} ${source:Version} of Debian\n' -- *) >"$documents/SOURCES"
    # shellcheck disable=SC2016  # the loader expands it; RPATH, unlike RUNPATH, holds for the libraries' libraries as well
    patchelf --force-rpath --set-rpath '$ORIGIN/../lib' "$archive/bin/hertzline"
    tar -C "$work" --sort=name --mtime="@$(git log -1 --format=%ct)" --owner=0 --group=0 --numeric-owner -c "$name" |
        gzip -n >"$folder/$name.tar.gz"
}

make_root() { # RELEASE FOLDER
    echo "Downloading $1 ..." >&2
    debootstrap --variant=minbase "$1" "$2" >"$work/log" 2>&1 || { tail "$work/log" >&2 && fail "debootstrap has failed"; }
    cp -r debian/tests "$2/tests"
}

in_root() { # ROOT COMMAND...: the mounts end with the command
    # shellcheck disable=SC2016  # expanded there
    unshare --mount --pid --fork --kill-child sh -eu -c 'mount -t proc proc "$0/proc"
        mount -t devpts -o newinstance,ptmxmode=666 devpts "$0/dev/pts"
        exec chroot "$0" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive "$@"' "$@"
}

attempt() { # ROOT TEXT COMMAND...
    echo "  $2" >&2
    in_root "$1" "${@:3}" >"$work/log" 2>&1 || { tail -n 30 "$work/log" >&2 && fail "failed: $2"; }
}

try_archive() { # ROOT
    place="/opt/a place" # paths have blanks, and nobody knows them before
    mkdir "$1/$place"
    tar -C "$1/$place" --strip-components 1 -xzf "$(echo "$folder"/hertzline-*.tar.gz)"
    for test in run-scene stream-and-listen; do
        attempt "$1" "archive: $test" env PATH="$place/bin:/usr/bin:/bin" sh "/tests/$test"
    done
    rm -r "${1:?}/$place"
}

# Prints the files of a root but those that record what apt did.
files_of() { # ROOT
    (cd "$1" && find . -path ./tests -prune -o -path ./packages -prune -o -path ./tmp -prune -o -path ./var/log -prune -o \
        -path ./var/cache -prune -o -path ./var/lib/apt -prune -o -path ./var/lib/dpkg -prune -o -print | sort)
}

# Makes packages of the next version, of the same files.
next_version() { # FOLDER
    mkdir "$1"
    for package in "$folder"/*.deb; do
        dpkg-deb -R "$package" "$work/next"
        sed -i 's/^Version: .*/&+1/' "$work/next/DEBIAN/control"
        dpkg-deb -b "$work/next" "$1" >/dev/null
        rm -r "$work/next"
    done
}

try_packages() { # ROOT
    mkdir "$1/packages"
    cp "$folder"/*.deb "$1/packages"
    next_version "$1/packages/next"
    mapfile -t names < <(for package in "$folder"/*.deb; do dpkg-deb -f "$package" Package; done)
    mapfile -t needed < <(for package in "$folder"/*.deb; do dpkg-deb -f "$package" Depends; done)
    mapfile -t for_tests < <(sed -n 's/^Depends: //p' "$1/tests/control" | tr -d , | tr ' ' '\n' | grep -v hertzline | sort -u)
    version=$(dpkg-deb -f "$folder"/hertzline_*.deb Version)
    install="apt-get install --yes --no-install-recommends"
    attempt "$1" "dependencies" sh -c 'apt-get update && apt-get satisfy --yes --no-install-recommends "$@"' - "${needed[@]}" "${for_tests[@]}"
    files_of "$1" >"$work/before"
    attempt "$1" "installation" sh -c "$install /packages/*.deb"
    for test in $(sed -n 's/^Tests: //p' "$1/tests/control" | tr -d ,); do
        attempt "$1" "packages: $test" sh "/tests/$test"
    done
    attempt "$1" "upgrade" sh -c "$install /packages/next/*.deb"
    # shellcheck disable=SC2016  # expanded there
    attempt "$1" "version" sh -c 'test "$(dpkg-query -W -f "\${Version}\n" "$@" | sort -u)" = "$0"' "$version+1" "${names[@]}"
    attempt "$1" "upgraded: run-scene" sh /tests/run-scene
    attempt "$1" "purge" apt-get purge --yes "${names[@]}"
    files_of "$1" >"$work/after"
    diff "$work/before" "$work/after" >&2 || fail "the purge leaves these files"
}

[ "$mode" = build ] || compgen -G "$folder/hertzline_*.deb" >/dev/null || fail "$folder has no packages: package.sh builds them"
case "$mode" in
build)
    need lintian lintian
    build "$work"
    rm -f "$folder"/{,lib,python3-}hertzline[-_]*
    cp "$work"/*.* "$folder"
    lintian --allow-root --pedantic --tag-display-limit 0 --fail-on error,warning "$folder"/*.changes
    ls "$folder"
    ;;
reproducible)
    need /usr/share/i18n/locales/tr_TR locales
    mkdir "$work/locales"
    localedef -i tr_TR -f UTF-8 "$work/locales/tr_TR.UTF-8"
    build "$work/again" LOCPATH="$work/locales" LC_ALL=tr_TR.UTF-8 TZ=Pacific/Chatham
    for package in "$folder"/*.deb "$folder"/*.dsc "$folder"/*.tar.xz; do
        cmp "$package" "$work/again/${package##*/}"
        echo "the same bytes: ${package##*/}"
    done
    ;;
archive)
    need patchelf patchelf
    make_archive
    ls "$folder"/*.tar.gz
    ;;
try)
    need debootstrap debootstrap
    [ "$(id -u)" -eq 0 ] || fail "--try needs root"
    export PATH=$PATH:/usr/sbin
    make_root bookworm "$work/bookworm"
    if compgen -G "$folder/hertzline-*.tar.gz" >/dev/null; then
        make_root trixie "$work/trixie"
        try_archive "$work/trixie"
        try_archive "$work/bookworm"
    fi
    try_packages "$work/bookworm"
    echo "all tried" >&2
    ;;
*) fail "no mode --$mode: --reproducible, --archive, --try" ;;
esac
