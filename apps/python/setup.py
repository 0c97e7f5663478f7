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

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent


def version():
    return re.search(r"project\(hertzline VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]


class CMakeBuild(build_ext):
    def build_extension(self, ext):
        target = pathlib.Path(self.get_ext_fullpath(ext.name)).resolve()
        given = os.environ.get("HERTZLINE_BUILD")
        build = pathlib.Path(given) if given else self.built()
        built = build / "python/hertzline" / target.name
        if not built.exists():
            sys.exit(f"{build} has no module for this Python: {built} is missing")
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(built, target)
        shutil.copy(ROOT / "apps/plot/hertzline_plot.py", target.parent / "_draw.py")

    def built(self):
        build = pathlib.Path(self.build_temp).resolve() / "cmake"
        options = ["-DCMAKE_BUILD_TYPE=Release", "-DHERTZLINE_TESTS=OFF", "-DHERTZLINE_BENCH=OFF", "-DHERTZLINE_PYTHON=ON",
                   f"-DPython_EXECUTABLE={sys.executable}"]
        subprocess.run(["cmake", "-S", ROOT, "-B", build, "-G", "Ninja", *options], check=True)
        jobs = [f"-j{self.parallel}"] if self.parallel else []
        subprocess.run(["cmake", "--build", build, "--target", "hertzline_python", *jobs], check=True)
        return build


setup(version=version(), ext_modules=[Extension("hertzline._native", [])], cmdclass={"build_ext": CMakeBuild})
