#!/usr/bin/python3
"""scripts/docs.sh builds the manual, of every document, and refuses faults: manual.py ROOT OUT

Exits with 77 where packages for the manual are missing.
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile


def build(project, out):
    """Returns exit status and messages of the project's docs.sh."""
    done = subprocess.run([project / "scripts/docs.sh", out], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def check_documents(root, out):
    """Each Markdown document that git knows is a page."""
    listed = subprocess.run(["git", "-C", root, "ls-files", "*.md"], capture_output=True, text=True, check=False)
    if listed.returncode != 0:
        print("not in a git repository: that each document is a page is not checked")
    missing = [name for name in listed.stdout.split() if not (out / name).with_suffix(".html").exists()]
    assert not missing, f"not in the manual: {missing}"


def check_bytes(root, out):
    """Nothing tells where the manual was built."""
    for path in filter(pathlib.Path.is_file, out.rglob("*")):
        text = path.read_bytes()
        for folder in (str(root), tempfile.gettempdir() + "/tmp."):
            assert folder.encode() not in text, f"{path} names the folder {folder}"


FAULTS = {  # in a document, and the complaint
    "[a document](gone.md)": "gone.md",
    "[a heading](README.md#gone-heading)": "gone-heading",
    "[a heading of this document](#gone-anchor)": "gone-anchor",
    "[a file](gone.toml)": "gone.toml",
    "![a picture](gone.png)": "gone.png",
}


def check_faults(root):
    """A small project with the settings of this one fails for each fault."""
    with tempfile.TemporaryDirectory() as folder:
        project = pathlib.Path(folder) / "project"
        for name in ("scripts", "docs/manual"):
            shutil.copytree(root / name, project / name)
        (project / "include/hertzline").mkdir(parents=True)
        (project / "include/hertzline/one.hpp").write_text("#pragma once\n// A header.\n\nnamespace hertzline {\n}  // namespace hertzline\n")
        (project / "docs/manual/index.rst").write_text("Index\n=====\n\n.. toctree::\n\n   README\n   headers\n")
        (project / "README.md").write_text("# Title\n\n## A heading\n\n[a heading](README.md#a-heading), [here](#a-heading)\n")
        status, text = build(project, project / "build/manual")
        assert status == 0, text
        with (project / "README.md").open("a") as readme:
            readme.write("\n" + "\n\n".join(FAULTS) + "\n")
        (project / "unlisted.md").write_text("# Not in the index\n")
        status, text = build(project, project / "build/manual")
        assert status != 0, "a manual with faults is built"
        missed = [word for word in [*FAULTS.values(), "unlisted.md"] if word not in text]
        assert not missed, f"no word of {missed} in:\n{text}"


def main(root, out):
    shutil.rmtree(out, ignore_errors=True)
    status, text = build(root, out)
    if status == 77:
        print("skipped:", text)
        sys.exit(77)
    assert status == 0, text
    check_documents(root, out)
    check_bytes(root, out)
    check_faults(root)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve())
