"""The notebooks run, and draw the pictures that the documents show: examples.py ROOT"""
import os
import pathlib
import subprocess
import sys
import tempfile

try:
    import matplotlib  # noqa: F401
except ImportError:
    print("skipped: matplotlib is not there")
    sys.exit(77)

root = pathlib.Path(sys.argv[1])
build = pathlib.Path(os.environ["HERTZLINE_PROGRAM"]).parent
kept = {path.name for path in (root / "docs/examples").glob("*.png")}
with tempfile.TemporaryDirectory() as folder:
    subprocess.run([sys.executable, "-B", root / "scripts/examples.py", "--build", build, "--out", folder], check=True,
                   timeout=580, cwd=folder)
    drawn = {path.name for path in pathlib.Path(folder).glob("*.png")}
assert drawn == kept, f"drawn {sorted(drawn)}, kept in docs/examples {sorted(kept)}"
for path in (root / "docs/examples").glob("*.py"):
    cells = path.read_text(encoding="utf-8").split("# %%")
    assert cells[0] == "" and len(cells) > 4, f"{path} is no notebook in percent format"
shown = (root / "docs/examples/README.md").read_text(encoding="utf-8")
for name in kept:
    assert f"]({name})" in shown, f"docs/examples/README.md does not show {name}"
