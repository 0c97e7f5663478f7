"""The wheel is built without a network, and works where it is unpacked: wheel.py ROOT BUILD FOLDER"""
import email
import os
import pathlib
import re
import shutil
import subprocess
import sys
import zipfile

root, build, folder = (pathlib.Path(name).resolve() for name in sys.argv[1:4])
sys.path.pop(0)  # where this file would be the module wheel
for module in ("build", "setuptools", "wheel", "pybind11"):
    try:
        __import__(module)
    except ImportError:
        print(f"skipped: the Python module {module} is not there: python3-{module}")
        sys.exit(77)

# setuptools writes beside its sources
work = folder / "wheel"
shutil.rmtree(work, ignore_errors=True)
work.mkdir(parents=True)
for name in ("CMakeLists.txt", "pyproject.toml", "setup.py", "apps/plot", "apps/python"):
    (work / name).parent.mkdir(parents=True, exist_ok=True)
    (shutil.copytree if (root / name).is_dir() else shutil.copy)(root / name, work / name)
environment = {**os.environ, "HERTZLINE_BUILD": str(build)}
environment.pop("PYTHONPATH")
subprocess.run([sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", work / "dist", work],
               check=True, env=environment, timeout=200)
(wheel,) = (work / "dist").glob("*.whl")
print(wheel.name)
assert "-cp311-" in wheel.name or f"-cp{sys.version_info[0]}{sys.version_info[1]}-" in wheel.name
with zipfile.ZipFile(wheel) as archive:
    names = set(archive.namelist())
    archive.extractall(work / "site")
(metadata,) = (work / "site").glob("*.dist-info/METADATA")
fields = email.message_from_string(metadata.read_text(encoding="utf-8"))
made_by = re.search("^HERTZLINE_PYBIND11:.*=(.+)", (build / "CMakeCache.txt").read_text(), re.M)[1]
reads_numpy_2 = tuple(map(int, made_by.split(".")[:2])) >= (2, 12)
assert fields["Requires-Python"] == ">=3.11", fields.items()
needed = re.sub("[ ()]", "", fields.get_all("Requires-Dist")[0])
assert needed == ("numpy>=1.24" if reads_numpy_2 else "numpy<2,>=1.24"), fields.items()
for name in ("__init__.py", "_draw/__init__.py", "_draw/waveforms.py", "_native.pyi", "py.typed"):
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

# A NumPy that the module would misread is refused.
if not reads_numpy_2:
    refused = subprocess.run([sys.executable, "-B", "-c", "import numpy; numpy.__version__ = '2.1.0'; import hertzline"],
                             env=environment, cwd=work, capture_output=True, text=True, timeout=100)
    assert refused.returncode == 1 and "ImportError: found NumPy 2.1.0, allowed is one before 2" in refused.stderr, refused
