#!/usr/bin/python3
"""The tests that a document names exist: names_of_tests.py BUILD DOCUMENT...

Names stand in the last cell of a row of a table whose head has "test"; * matches anything.
"""
import fnmatch
import pathlib
import re
import subprocess
import sys


def named(document):
    """Returns the names in each table with a column of tests."""
    names, in_table = [], False
    for line in pathlib.Path(document).read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith("|") else []
        if not cells:
            in_table = False
        elif cells[-1] == "test":
            in_table = True
        elif in_table:
            names += re.findall(r"`([^`]+)`", cells[-1])
    return names


def there(build):
    """Returns the names that ctest lists, and those of GoogleTest without folder, instance and parameter."""
    listed = subprocess.run(["ctest", "--test-dir", build, "-N"], check=True, capture_output=True, text=True).stdout
    names = [match[1].split("  #")[0] for match in re.finditer(r"Test +#\d+: (.*)", listed)]
    return set(names) | {part for name in names for part in name.split("/") if re.fullmatch(r"\w+\.\w+", part)}


build, *documents = sys.argv[1:]
tests = there(build)
for document in documents:
    names = named(document)
    assert names, f"{document} names no tests"
    missing = [name for name in names if not fnmatch.filter(tests, name)]
    assert not missing, f"{document} names tests that are not there: {missing}"
