#!/usr/bin/python3
"""Names the tests that ctest skipped, with their reasons: skipped.py JUNIT_FILE"""
import sys
import xml.etree.ElementTree

for case in xml.etree.ElementTree.parse(sys.argv[1]).iter("testcase"):
    if case.find("skipped") is not None:
        said = [line.strip() for line in (case.findtext("system-out") or "").splitlines()]
        # googletest prints the reason in the line after the place; the project's own tests print "skipped: REASON"
        after_place = [after for line, after in zip(said, said[1:]) if line.endswith(": Skipped")]
        own = [line.removeprefix("skipped: ") for line in said if line.startswith("skipped: ")]
        print(f"skipped: {case.get('name')}: {(own + after_place + ['no reason given'])[0]}")
