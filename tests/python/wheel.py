"""The wheel is built without a network, and works where it is unpacked: wheel.py ROOT BUILD FOLDER"""
import os
import pathlib
import shutil
import subprocess
import sys
import zipfile

root, build, folder = (pathlib.Path(name).resolve() for name in sys.argv[1:4])
for module in ("build", "setuptools", "wheel"):
    try:
        __import__(module)
    except ImportError:
        print(f"skipped: the Python module {module} is not there: python3-{module}")
        sys.exit(77)

# setuptools writes beside its sources
work = folder / "wheel"
shutil.rmtree(work, ignore_errors=True)
work.mkdir(parents=True)
for name in ("CMakeLists.txt", "apps/plot", "apps/python"):
    (work / name).parent.mkdir(parents=True, exist_ok=True)
    (shutil.copytree if (root / name).is_dir() else shutil.copy)(root / name, work / name)
environment = {**os.environ, "HERTZLINE_BUILD": str(build)}
environment.pop("PYTHONPATH")
subprocess.run([sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", work / "dist", work / "apps/python"],
               check=True, env=environment, timeout=200)
(wheel,) = (work / "dist").glob("*.whl")
print(wheel.name)
assert "-cp311-" in wheel.name or f"-cp{sys.version_info[0]}{sys.version_info[1]}-" in wheel.name
with zipfile.ZipFile(wheel) as archive:
    names = set(archive.namelist())
    archive.extractall(work / "site")
for name in ("__init__.py", "_draw.py", "_native.pyi", "py.typed"):
    assert f"hertzline/{name}" in names, (name, sorted(names))

USE = """
import hertzline, pathlib
assert pathlib.Path(hertzline.__file__).is_relative_to(pathlib.Path.cwd() / "site"), hertzline.__file__
r = hertzline.scene("paper-wall").run()
assert r["v_out"].any() and r.summary["version"] == hertzline.__version__
print(hertzline.__version__, r)
"""
environment["PYTHONPATH"] = str(work / "site")
subprocess.run([sys.executable, "-B", "-c", USE], check=True, env=environment, cwd=work, timeout=100)
