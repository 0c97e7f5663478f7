#!/usr/bin/env python3
"""packages.py ROOT: checks that the Debian packages agree with the project.

The versions of CMakeLists.txt and debian/changelog are one. Packages to build with are those of scripts/packages.txt. The documentation
has every document.
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(sys.argv[1])

# Names of control files, and the packages that provide them.
PROVIDED_BY = {"debhelper-compat": "debhelper"}
# Packages that `scripts/install_packages.sh` installs and debian/control does not name.
NOT_PACKAGED = {
    "g++": "each build of a package has build-essential",
    "libgtest-dev": "tests are not built",
    "libgmock-dev": "tests are not built",
    "librapidcheck-dev": "tests are not built",
    "libbenchmark-dev": "benchmarks are not built",
    "python3-venv": "pip installs nothing",
}


def fields(path):
    """Returns the paragraphs of a control file, each a dict of its fields."""
    text = (ROOT / path).read_text(encoding="utf-8")
    paragraphs = [re.findall(r"^([\w-]+):((?:.|\n )*)", paragraph, re.M) for paragraph in re.split(r"\n\n+", text.strip())]
    return [{name: value.strip() for name, value in paragraph} for paragraph in paragraphs]


def names(relation):
    """Returns the packages of a relation, without versions and substitution variables."""
    words = (part.split("(")[0].strip() for part in re.split(r"[,|]", relation))
    return {PROVIDED_BY.get(word, word) for word in words if word and not word.startswith("${")}


def listed():
    """Returns the mark of each package of scripts/packages.txt: "", "tests", "docs" or "optional"."""
    marks = {}
    for line in (ROOT / "scripts/packages.txt").read_text(encoding="utf-8").splitlines():
        words = line.split()
        if not words or line.startswith("#"):
            continue
        marked = words[0] in ("tests", "docs", "optional")
        marks[words[marked]] = words[0] if marked else ""
    return marks


def check_versions():
    project = re.search(r"^project\(hertzline VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"), re.M)[1]
    packaged = re.match(r"hertzline \((\S+)\)", (ROOT / "debian/changelog").read_text(encoding="utf-8"))[1]
    if packaged != project:
        yield f"debian/changelog has version {packaged}, CMakeLists.txt {project}"


def check_packages():
    source, *binaries = fields("debian/control")
    to_build = names(source["Build-Depends"])
    to_run = set().union(*(names(binary.get(kind, "")) for binary in binaries for kind in ("Depends", "Recommends", "Suggests")))
    marks = listed()
    for name in sorted(to_build - marks.keys()):
        yield f"debian/control builds with {name}, which scripts/packages.txt does not name"
    for name in sorted(name for name, mark in marks.items() if not mark and name not in NOT_PACKAGED):
        if name not in to_build and not (name.startswith("python3") and name in to_run):
            yield f"scripts/packages.txt names {name}, which debian/control does not"
    for name in sorted((to_build | to_run) & NOT_PACKAGED.keys()):
        yield f"debian/control names {name}: {NOT_PACKAGED[name]}"


def check_documents():
    documents = sorted(path.relative_to(ROOT).as_posix() for depth in ("*.md", "*/*.md", "*/*/*.md") for path in ROOT.glob(depth))
    patterns = [line.split() for line in (ROOT / "debian/hertzline-doc.install").read_text(encoding="utf-8").splitlines()]
    installed = {}
    for pattern, folder in patterns:
        for path in ROOT.glob(pattern):
            for file in path.rglob("*") if path.is_dir() else [path]:
                installed[file.relative_to(ROOT).as_posix()] = f"{folder}/{file.relative_to(path.parent).as_posix()}"
    for document in documents:
        if document.startswith("build/"):
            continue
        if document not in installed:
            yield f"debian/hertzline-doc.install leaves out {document}"
        elif installed[document] != f"usr/share/doc/hertzline/{document}":  # links between documents are relative
            yield f"debian/hertzline-doc.install puts {document} at {installed[document]}"


def main():
    faults = [fault for check in (check_versions, check_packages, check_documents) for fault in check()]
    print("\n".join(faults) or "the packages agree with the project")
    raise SystemExit(1 if faults else 0)


if __name__ == "__main__":
    main()
