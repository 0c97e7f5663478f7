#!/usr/bin/env python3
"""Which part of the project may use which: the rooms of each tree from the lowest to the highest.

A file may use its own room and those before it. layers.py CHECK [ARGUMENT]:
  includes          every #include "..." goes to the same room or a lower one
  symbols BUILD     so does every symbol that an object file of the libraries takes from another one
  folders           no folder of core, stream or apps holds more than a dozen modules, and no C++ source more than 350 lines
  self-test         the checks find wrong includes, symbols and folders that are made for them
"""

import pathlib
import re
import subprocess
import sys
import tempfile
from collections import namedtuple

ROOT = pathlib.Path(__file__).resolve().parent.parent

# A room is a folder of the tree, or files that lie in the tree itself, by their names without ending.
ROOMS = {
    "core": [
        ["scene", "shipped_scenes_data"],
        ["plate"],
        ["model"],
        ["taps"],
        ["samples"],
        ["integrators"],
        ["solvers"],
        ["step_choice"],
        ["simulation"],
    ],
    "stream": [
        ["float32", "scene_json", "provenance", "measures", "resources"],
        ["files"],
        ["recordings"],
        ["sweep"],
        ["optimise"],
        ["wire"],
        ["sources"],
        ["pipeline"],
    ],
    "apps": [
        ["python"],
        ["command", "options"],
        ["console"],
        ["arguments"],
        ["commands"],
        ["program"],
        ["hertzline", "allocator", "mpi"],
    ],
}

# What each tree may use beside itself.
TREES = {
    "core": [],
    "stream": ["core"],
    "apps": ["core", "stream"],
    "tests": ["core", "stream", "apps"],
    "bench": ["core", "stream", "apps", "tests"],
}

MAX_MODULES = 12
MAX_LINES = 350
INCLUDE = re.compile(r'\s*#\s*include\s*"([^"]+)"')
Place = namedtuple("Place", "tree room name")  # room: its height, or None


class Fault(Exception):
    pass


def place_of(path):
    """The place of a source, given by its path from the root."""
    tree, _, rest = path.partition("/")
    if tree not in TREES:
        raise Fault(f"{path} is in none of {', '.join(TREES)}")
    if tree not in ROOMS:
        return Place(tree, None, tree)
    name = re.split(r"[/.]", rest)[0]
    for height, room in enumerate(ROOMS[tree]):
        if name in room:
            return Place(tree, height, f"{tree}/{name}")
    raise Fault(f"{path} is in no room of {tree}: add {name} to the list in tests/layers.py")


def may_use(user, used):
    if user.tree == used.tree:
        return user.room is None or used.room <= user.room
    return used.tree in TREES[user.tree]


def sources(root):
    for tree in TREES:
        for path in sorted((root / tree).rglob("*")):
            if path.suffix in (".hpp", ".cpp"):
                yield path


def includes_faults(root):
    for path in sources(root):
        source = path.relative_to(root).as_posix()
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            match = INCLUDE.match(line)
            if not match or not (root / match[1]).exists():  # generated, or another project's
                continue
            try:
                user, used = place_of(source), place_of(match[1])
                if not may_use(user, used):
                    yield f"{source}:{number}: {user.name} may not include {used.name}: {match[1]}"
            except Fault as fault:
                yield f"{source}:{number}: {fault}"


UNITED = re.compile(r"Unity/unity_(.+)_cxx\.cxx")  # as cmake/Flags.cmake names the sources of a folder that are compiled as one


def source_of(tree, object_name):
    """The source of an object file, or the folder of its sources."""
    united = UNITED.match(object_name)
    return united[1].replace("-", "/") if united else f"{tree}/{object_name.removesuffix('.o')}"


def object_files(build):
    """(path of the source or its folder from the root, object file) of the two libraries."""
    for tree in ("core", "stream"):
        folder = build / tree / "CMakeFiles" / f"hertzline_{tree}.dir"
        for path in sorted(folder.rglob("*.o")):
            yield source_of(tree, path.relative_to(folder).as_posix()), path


def symbols_of(objects):
    """(source, kind, symbol) of each global symbol."""
    for source, path in objects:
        text = subprocess.run(["nm", "--extern-only", "--demangle", path], check=True, capture_output=True, text=True).stdout
        for line in text.splitlines():
            kind, symbol = line[17:].split(" ", 1)
            yield source, kind, symbol


def symbols_faults(symbols):
    """A symbol with several definitions (an inline function) belongs to nobody."""
    symbols = list(symbols)
    definitions = {symbol: source for source, kind, symbol in symbols if kind in "TDBRG"}
    seen = set()
    for source, kind, symbol in symbols:
        if kind != "U" or symbol not in definitions:
            continue
        try:
            user, used = place_of(source), place_of(definitions[symbol])
        except Fault as fault:
            if str(fault) not in seen:
                seen.add(str(fault))
                yield str(fault)
            continue
        if not may_use(user, used):
            yield f"{source}: {user.name} may not need {symbol} of {definitions[symbol]}"


def folders_faults(root):
    for tree in ROOMS:
        folders = [root / tree, *(path for path in sorted((root / tree).rglob("*")) if path.is_dir())]
        for folder in folders:
            modules = {path.stem for path in folder.iterdir() if path.is_dir() or path.suffix in (".hpp", ".cpp")}
            if len(modules) > MAX_MODULES:
                yield f"{folder.relative_to(root)}: {len(modules)} modules, allowed: at most {MAX_MODULES}"
            for source in sorted(path for path in folder.iterdir() if path.suffix in (".hpp", ".cpp")):
                lines = len(source.read_text(encoding="utf-8").splitlines())
                if lines > MAX_LINES:
                    yield f"{source.relative_to(root)}: {lines} lines, allowed: at most {MAX_LINES}"


def self_test():
    def expect(what, found, wanted):
        if found != wanted:
            raise SystemExit(f"{what}: found {found}, expected {wanted}")

    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)

        def write(path, text=""):
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_text(text, encoding="utf-8")

        write("core/model/chain.hpp", '#include "core/scene/scene.hpp"\n#include <vector>\n')
        write("core/scene/scene.hpp", '#include "git_hash.hpp"\n#include "core/scene/text.hpp"\n')
        write("core/scene/text.hpp")
        write("apps/command.hpp", '#include "stream/wire/frame.hpp"\n')
        write("stream/wire/frame.hpp", '#include "core/model/chain.hpp"\n')
        write("bench/long_run.cpp", '#include "tests/support/runs.hpp"\n')
        write("tests/support/runs.hpp", '#include "apps/command.hpp"\n')
        expect("right includes", list(includes_faults(root)), [])

        write("core/scene/text.hpp", '\n  # include "core/model/chain.hpp"\n')
        write("core/taps.cpp", '#include "stream/wire/frame.hpp"\n')
        write("stream/files/input.cpp", '#include "stream/wire/frame.hpp"\n#include "apps/command.hpp"\n')
        write("stream/attic.cpp", '#include "core/taps.cpp"\n')
        expect("wrong includes", list(includes_faults(root)), [
            "core/scene/text.hpp:2: core/scene may not include core/model: core/model/chain.hpp",
            "core/taps.cpp:1: core/taps may not include stream/wire: stream/wire/frame.hpp",
            "stream/attic.cpp:1: stream/attic.cpp is in no room of stream: add attic to the list in tests/layers.py",
            "stream/files/input.cpp:1: stream/files may not include stream/wire: stream/wire/frame.hpp",
            "stream/files/input.cpp:2: stream/files may not include apps/command: apps/command.hpp",
        ])

        for number in range(MAX_MODULES):
            write(f"core/model/m{number}.hpp")
            write(f"core/model/m{number}.cpp")
        write("stream/wire/frame.hpp", "//\n" * (MAX_LINES + 1))
        expect("full folder, long source", list(folders_faults(root)), [
            "core/model: 13 modules, allowed: at most 12",
            "stream/wire/frame.hpp: 351 lines, allowed: at most 350",
        ])

    expect("source alone", source_of("core", "integrators/grid_kernels.cpp.o"), "core/integrators/grid_kernels.cpp")
    expect("united sources", source_of("core", "Unity/unity_core-step_choice_cxx.cxx.o"), "core/step_choice")
    symbols = [
        ("core/scene/text.cpp", "T", "trimmed()"),
        ("core/scene/text.cpp", "W", "inlined()"),
        ("core/model/chain.cpp", "T", "stiffness()"),
        ("core/model/chain.cpp", "U", "trimmed()"),
        ("core/model/chain.cpp", "U", "malloc"),
        ("stream/scene_json.cpp", "U", "stiffness()"),
    ]
    expect("right symbols", list(symbols_faults(symbols)), [])
    symbols.append(("core/scene/text.cpp", "U", "stiffness()"))
    expect("wrong symbols", list(symbols_faults(symbols)),
           ["core/scene/text.cpp: core/scene may not need stiffness() of core/model/chain.cpp"])


def main():
    match sys.argv[1:]:
        case ["includes"]:
            faults = list(includes_faults(ROOT))
        case ["symbols", build]:
            objects = list(object_files(pathlib.Path(build)))
            faults = list(symbols_faults(symbols_of(objects))) if objects else [f"{build}: no object files"]
        case ["folders"]:
            faults = list(folders_faults(ROOT))
        case ["self-test"]:
            return self_test()
        case _:
            raise SystemExit(__doc__)
    print("\n".join(faults))
    raise SystemExit(1 if faults else 0)


if __name__ == "__main__":
    main()
