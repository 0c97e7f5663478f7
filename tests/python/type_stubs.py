"""The package's annotations hold, its stubs match the module, and all public names have docstrings."""
import inspect
import pathlib
import subprocess
import sys
import tempfile

import hertzline

package = pathlib.Path(hertzline.__file__).parent
assert (package / "py.typed").exists() and (package / "_native.pyi").exists()

undocumented = []
for name in hertzline.__all__:
    thing = getattr(hertzline, name)
    if name == "__version__":
        continue
    if not thing.__doc__:
        undocumented.append(name)
    for member, value in vars(thing).items() if inspect.isclass(thing) else ():
        if not member.startswith("_") and (callable(value) or isinstance(value, property)):
            if not inspect.getdoc(getattr(thing, member)):
                undocumented.append(f"{name}.{member}")
assert not undocumented, f"without a docstring: {undocumented}"

stubs = (package / "_native.pyi").read_text()
import hertzline._native as native  # noqa: E402

for name in vars(native):
    assert name.startswith("__") or f"class {name}:" in stubs or f"def {name}(" in stubs or f"{name}: " in stubs, name
    for member in vars(getattr(native, name)) if inspect.isclass(getattr(native, name)) else ():
        assert member.startswith("_") or f"def {member}(" in stubs, f"{name}.{member}"

try:
    import mypy  # noqa: F401
except ImportError:
    print("skipped: mypy is not there")
    sys.exit(77)

USER = """
import hertzline
import numpy as np

s = hertzline.scene("paper-vitreous-carbon", end={"thickness_m": 0.4e-3})
r: hertzline.Result = s.run(taps=["v_out"])
peak: float = float(np.abs(r["v_out"]).max())
table: hertzline.Table = hertzline.sweep(s, {"chain.spheres": [5, 6]}, jobs=2)
found: hertzline.SearchResult = hertzline.optimise(s, {"chain.preload_n": "0.1..1"}, minimise="thd_r")
best: hertzline.Scene = found.best_scene
with hertzline.listen("tcp://127.0.0.1:5573", "v_out", gaps="mark") as live:
    for block in live:
        first: np.float32 = block.samples[0]
"""
# The modules that draw have no annotations.
SETTINGS = "[mypy]\nstrict = True\nignore_missing_imports = True\n[mypy-hertzline._draw.*]\nignore_errors = True\n"
with tempfile.TemporaryDirectory() as folder:
    (pathlib.Path(folder) / "user.py").write_text(USER)
    (pathlib.Path(folder) / "mypy.ini").write_text(SETTINGS)
    checked = subprocess.run(
        [sys.executable, "-m", "mypy", "--cache-dir", folder, "user.py",
         *(str(path) for path in sorted(package.glob("*.py")))],
        cwd=folder, env={"MYPYPATH": str(package.parent), "PATH": "/usr/bin:/bin", "HOME": folder},
        capture_output=True, text=True, timeout=280, check=False)
print(checked.stdout, checked.stderr)
sys.exit(checked.returncode)
