"""The extension of the wheel: CMake builds it, as it builds all of the project.

HERTZLINE_BUILD names a build of CMake's whose module is taken as it is; without it one is configured and built, of the module
alone, in setuptools' own folder.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

import pybind11
from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext
from setuptools.command.sdist import sdist

ROOT = pathlib.Path(__file__).resolve().parent
GIVEN_BUILD = os.environ.get("HERTZLINE_BUILD")


def search(pattern, path):
    return re.search(pattern, path.read_text(encoding="utf-8"), re.M)[1]


def numpy():
    """Returns the versions of NumPy that the module can read: pybind11 knows the layout of NumPy 2 from 2.12 on."""
    used = search(r"^HERTZLINE_PYBIND11:.*=(.+)", pathlib.Path(GIVEN_BUILD) / "CMakeCache.txt") if GIVEN_BUILD else pybind11.__version__
    return "numpy>=1.24" if tuple(map(int, used.split(".")[:2])) >= (2, 12) else "numpy>=1.24,<2"


class WithCommit(sdist):
    """Writes the commit into the copied sources, as `git archive` does: no repository goes with them."""

    def make_release_tree(self, base_dir, files):
        super().make_release_tree(base_dir, files)
        described = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"],
                                   capture_output=True, text=True, check=False)
        path = pathlib.Path(base_dir, "cmake/GitHash.cmake")
        text = path.read_text(encoding="utf-8").replace("$Format:%H$", described.stdout.strip() or "$Format:%H$")
        path.unlink()  # perhaps a second name of the original
        path.write_text(text, encoding="utf-8")


class CMakeBuild(build_ext):
    def build_extension(self, ext):
        target = pathlib.Path(self.get_ext_fullpath(ext.name)).resolve()
        build = pathlib.Path(GIVEN_BUILD) if GIVEN_BUILD else self.built()
        built = build / "python/hertzline" / target.name
        if not built.exists():
            sys.exit(f"{build} has no module for this Python: {built} is missing")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(built, target)
        shutil.copytree(ROOT / "apps/plot/hertzline_pictures", target.parent / "_draw", dirs_exist_ok=True,
                        ignore=shutil.ignore_patterns("__pycache__"))

    def built(self):
        build = pathlib.Path(self.build_temp).resolve() / "cmake"
        options = ["-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_UNITY_BUILD=ON", "-DHERTZLINE_TESTS=OFF", "-DHERTZLINE_BENCH=OFF",
                   "-DHERTZLINE_WERROR=OFF", "-DHERTZLINE_PYTHON=ON", f"-DPython_EXECUTABLE={sys.executable}",
                   f"-Dpybind11_DIR={pybind11.get_cmake_dir()}"]
        subprocess.run(["cmake", "-S", ROOT, "-B", build, "-G", "Ninja", *options], check=True)
        jobs = [f"-j{self.parallel}"] if self.parallel else []
        subprocess.run(["cmake", "--build", build, "--target", "hertzline_python", *jobs], check=True)
        return build


setup(version=search(r"^project\(hertzline VERSION (\S+)", ROOT / "CMakeLists.txt"), install_requires=[numpy()],
      ext_modules=[Extension("hertzline._native", [])], cmdclass={"build_ext": CMakeBuild, "sdist": WithCommit})
