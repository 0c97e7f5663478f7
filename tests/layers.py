#!/usr/bin/env python3
"""Checks the order of core's modules, from the lowest to the highest: each may use itself and lower ones.

The modules of the whole project need no such test: a target finds only the headers of modules that it links (cmake/Modules.cmake).
layers.py CHECK [ARGUMENT]:
  includes          every #include "core/..." goes to the same module or a lower one
  symbols BUILD     so does every symbol that an object file takes from another one
  self-test         the checks find wrong includes and symbols made for this test
"""
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
MODULES = ["simd", "scene", "plate", "model", "integrators", "solvers", "array", "simulation", "step_choice"]
INCLUDE = re.compile(r'\s*#\s*include\s*"core/([^"]+)"')
UNITED = re.compile(r"Unity/unity_core-(\w+?)(?:-[\w-]+)?_cxx\.cxx")  # as cmake/Flags.cmake names united sources


def height_of(path):
    """Returns the height of a module, given the path of one of its sources in core."""
    united = UNITED.match(path)
    module = united[1] if united else re.split(r"[/.]", path)[0]
    return MODULES.index("scene" if module == "shipped_scenes_data" else module)


def includes_faults(root):
    for path in sorted((root / "core").rglob("*.[ch]pp")):
        source = path.relative_to(root / "core").as_posix()
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            match = INCLUDE.match(line)
            if match and height_of(match[1]) > height_of(source):
                yield f"core/{source}:{number}: {MODULES[height_of(source)]} may not include core/{match[1]}"


def symbols_of(build):
    """Yields (source, kind, symbol) of each global symbol."""
    folder = pathlib.Path(build) / "core/CMakeFiles/hertzline_core.dir"
    for path in sorted(folder.rglob("*.o")):
        text = subprocess.run(["nm", "--extern-only", "--demangle", path], check=True, capture_output=True, text=True).stdout
        for line in text.splitlines():
            kind, symbol = line[17:].split(" ", 1)
            yield path.relative_to(folder).as_posix(), kind, symbol


def symbols_faults(symbols):
    """Yields uses of higher modules. A symbol with several definitions (an inline function) belongs to no module."""
    symbols = list(symbols)
    definitions = {symbol: source for source, kind, symbol in symbols if kind in "TDBRG"}
    if not definitions:
        yield "no object files"
    for source, kind, symbol in symbols:
        defined = definitions.get(symbol)
        if kind == "U" and defined and height_of(defined) > height_of(source):
            yield f"core/{source}: {MODULES[height_of(source)]} may not need {symbol} of core/{defined}"


def self_test():
    def expect(found, wanted):
        if found != wanted:
            raise SystemExit(f"found {found}, expected {wanted}")

    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)

        def write(path, text):
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).write_text(text, encoding="utf-8")

        write("core/model/chain.hpp", '#include "core/scene/scene.hpp"\n#include <vector>\n')
        write("core/scene/scene.hpp", '\n  # include "core/model/chain.hpp"\n')
        write("core/solvers/solver.cpp", '#include "core/simulation.hpp"\n')
        expect(list(includes_faults(root)), ["core/scene/scene.hpp:2: scene may not include core/model/chain.hpp",
                                             "core/solvers/solver.cpp:1: solvers may not include core/simulation.hpp"])

    expect(height_of("Unity/unity_core-step_choice_cxx.cxx.o"), MODULES.index("step_choice"))
    expect(height_of("Unity/unity_core-integrators-simd_cxx.cxx.o"), MODULES.index("integrators"))
    symbols = [("scene/text.cpp.o", "T", "trimmed()"), ("scene/text.cpp.o", "W", "inlined()"), ("model/chain.cpp.o", "T", "stiffness()"),
               ("model/chain.cpp.o", "U", "trimmed()"), ("model/chain.cpp.o", "U", "malloc")]
    expect(list(symbols_faults(symbols)), [])
    symbols.append(("scene/text.cpp.o", "U", "stiffness()"))
    expect(list(symbols_faults(symbols)), ["core/scene/text.cpp.o: scene may not need stiffness() of core/model/chain.cpp.o"])


def main():
    match sys.argv[1:]:
        case ["includes"]:
            faults = list(includes_faults(ROOT))
        case ["symbols", build]:
            faults = list(symbols_faults(symbols_of(build)))
        case ["self-test"]:
            return self_test()
        case _:
            raise SystemExit(__doc__)
    print("\n".join(faults))
    raise SystemExit(1 if faults else 0)


if __name__ == "__main__":
    main()
