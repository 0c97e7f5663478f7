"""The source package has all that its wheel is built from, and the commit: source_package.py ROOT FOLDER"""
import pathlib
import shutil
import subprocess
import sys
import tarfile

root, folder = (pathlib.Path(name).resolve() for name in sys.argv[1:3])
sys.path.pop(0)
for module in ("build", "setuptools"):
    try:
        __import__(module)
    except ImportError:
        print(f"skipped: the Python module {module} is not there: python3-{module}")
        sys.exit(77)

# setuptools writes beside its sources
work = folder / "source_package"
shutil.rmtree(work, ignore_errors=True)
shutil.copytree(root, work / "tree", symlinks=True, ignore=shutil.ignore_patterns("build", "env", "node_modules", ".git", "__pycache__"))
hash_file = work / "tree/cmake/GitHash.cmake"
commit = "0123456789abcdef0123456789abcdef01234567"
fake_git = work / "bin/git"
fake_git.parent.mkdir()
fake_git.write_text(f"#!/bin/sh\necho {commit}\n", encoding="utf-8")
fake_git.chmod(0o755)
subprocess.run([sys.executable, "-m", "build", "--sdist", "--no-isolation", "--outdir", work / "dist", work / "tree"],
               check=True, stdout=subprocess.DEVNULL, timeout=200, env={"PATH": f"{fake_git.parent}:/usr/bin:/bin", "HOME": str(work)})
assert commit not in hash_file.read_text(encoding="utf-8"), "the copied file shares its bytes with the tree's"
(package,) = (work / "dist").glob("*.tar.gz")
with tarfile.open(package) as archive:
    archive.extractall(work)
unpacked = work / package.name.removesuffix(".tar.gz")
assert f'"{commit}"' in (unpacked / "cmake/GitHash.cmake").read_text(encoding="utf-8")

# The modules that CMakeLists.txt names, with all of their files; CMake finds its sources.
modules = ("apps", "cmake", "core", "include", "measures", "recordings", "scenes", "scope", "stream", "studies")
missing = [path.relative_to(work / "tree") for module in modules for path in (work / "tree" / module).rglob("*")
           if path.is_file() and not (unpacked / path.relative_to(work / "tree")).exists()]
assert not missing, missing
subprocess.run(["cmake", "-S", unpacked, "-B", work / "configured", "-G", "Ninja", "-DHERTZLINE_TESTS=OFF", "-DHERTZLINE_BENCH=OFF",
                "-DHERTZLINE_PYTHON=ON", f"-DPython_EXECUTABLE={sys.executable}"], check=True, stdout=subprocess.DEVNULL,
               timeout=200)
shutil.rmtree(work)
