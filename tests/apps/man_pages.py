#!/usr/bin/env python3
"""The manual pages say what the program knows: man_pages.py HERTZLINE

Each subcommand and option of --help has its page and entry, with a description, and the pages have no others; so have the keys of
scenes and the numbers of a summary. man and mandoc, where they are installed, find no fault.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

program = sys.argv[1]
root = pathlib.Path(__file__).resolve().parents[2]


def output_of(*words):
    return subprocess.run([program, *words], check=True, capture_output=True, text=True).stdout


def expect_equal(place, found, allowed):
    assert found == allowed, f"{place}: only there {sorted(found - allowed)}, missing {sorted(allowed - found)}"


def options_of_help(text):
    """The options' names, as "-o,--output", and the positionals'."""
    block = re.search(r"\nOptions:\n(.*?)(\n\n|\Z)", text, re.DOTALL)[1]
    positionals = re.search(r"\nPositionals:\n(.*?)\n\n", text, re.DOTALL)
    return (set(re.findall(r"^  (-[\w,-]+)", block, re.MULTILINE)),
            set(re.findall(r"^  (\S+)", positionals[1] if positionals else "", re.MULTILINE)))


def entries(page, section):
    """The entries of a section of a page: term -> paragraph."""
    found = re.search(rf"^\.SH {section}\n(.*?)(?=^\.SH|\Z)", page, re.DOTALL | re.MULTILINE)
    rows = re.findall(r"^\.TP\n\\fB(.*?)\\fR.*\n((?:(?!\.).*\n)*)", found[1] if found else "", re.MULTILINE)
    terms = [term.replace("\\-", "-").replace(", ", ",") for term, _ in rows]
    assert len(terms) == len(set(terms)), f"{section}: an entry stands twice"
    for term, (_, text) in zip(terms, rows):
        assert re.search(r"\w", text), f"{section}: {term} has no description"
    return set(terms)


def check_commands(pages):
    commands = re.findall(r"^  (\w+) ", re.search(r"\nSubcommands:\n(.*?)\n\n", output_of("--help"), re.DOTALL)[1], re.MULTILINE)
    assert len(commands) > 10
    expect_equal("pages", set(pages), {"hertzline.1", "hertzline-scene.5", *(f"hertzline-{command}.1" for command in commands)})
    for command in [None, *commands]:
        name = f"hertzline-{command}.1" if command else "hertzline.1"
        options, positionals = options_of_help(output_of(*([command] if command else []), "--help"))
        expect_equal(name, entries(pages[name], "OPTIONS"), options)
        expect_equal(name, entries(pages[name], "ARGUMENTS"), positionals)
        assert "\n.SH EXAMPLES\n.nf\n.RS 4\nhertzline " in pages[name], name
    for name, page in pages.items():
        others = {f"{other}.{section}" for other, section in re.findall(r"^\.BR (\S+) \((\d)\)", page.replace("\\-", "-"), re.MULTILINE)}
        expect_equal(f"{name}, SEE ALSO", others, set(pages) - {name})
    assert output_of("man") == pages["hertzline.1"]
    named = set(re.findall(r"[\w/-]+\.md", "".join(pages.values()).replace("\\-", "-")))
    assert "docs/measures.md" in named and "/usr/share/doc/hertzline" in pages["hertzline.1"]
    for document in named:
        assert (root / document).is_file(), document
    assert output_of("man", "run") == pages["hertzline-run.1"]


def check_tables(pages):
    keys = re.findall(r"^[|] `([^`]+)`", output_of("scenes", "--keys"), re.MULTILINE)
    expect_equal("keys", entries(pages["hertzline-scene.5"], "KEYS"), set(keys))
    scenes = {scene["name"] for scene in json.loads(output_of("scenes", "--json"))}
    expect_equal("scenes", entries(pages["hertzline-scene.5"], "SHIPPED SCENES"), scenes)
    materials = {material["name"] for material in json.loads(output_of("materials", "--json"))}
    expect_equal("materials", entries(pages["hertzline-scene.5"], "MATERIALS"), materials)
    taps = re.search(r"--tap OUTPUT.*?repeatable:(.*?)--", output_of("run", "--help"), re.DOTALL)[1]
    expect_equal("outputs", entries(pages["hertzline-run.1"], "OUTPUTS"), set(re.findall(r"\w+", taps)))
    explained = entries(pages["hertzline-run.1"], "NUMBERS OF THE SUMMARY")
    for scene in ("paper-vitreous-carbon", "wet-off-axis"):
        summary = json.loads(output_of("run", scene, "--json"))
        names = {name for name, value in summary.items() if not isinstance(value, dict)} - {"warnings"}  # sentences
        assert names <= explained, names - explained


def check_format(folder):
    for file in sorted(folder.glob("man?/*")):
        for command in (["man", "--warnings", "-E", "UTF-8", "-l", file], ["mandoc", "-T", "lint", "-W", "warning", file]):
            if shutil.which(command[0]):
                run = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "LC_ALL": "C.UTF-8"})
                said = run.stderr + (run.stdout if command[0] == "mandoc" else "")
                faults = [line for line in said.splitlines() if "missing date" not in line]  # a page has no date: builds repeat
                assert not faults, "\n".join(faults)
            else:
                print(command[0], "is not installed")


with tempfile.TemporaryDirectory() as place:
    folder = pathlib.Path(place)
    output_of("man", "-o", place)
    all_pages = {file.name: file.read_text(encoding="utf-8") for file in folder.glob("man?/*")}
    assert all(file.parent.name == "man" + file.suffix[1:] for file in folder.glob("man?/*"))
    check_commands(all_pages)
    check_tables(all_pages)
    check_format(folder)
