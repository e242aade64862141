#!/usr/bin/env python3
"""Fails when a line of prose, in a comment or on a page, is longer than 100 columns.

Tables, code, headings, pictures, aligned formulas and single words may be longer.
"""

import re
import subprocess
import sys
from pathlib import Path

COLUMNS = 100
COMMENT = re.compile(r"\s*//[/!]?(?: |$)(.*)")


def prose(path, lines):
    """The number, the text and the whole of each line that may be prose."""
    fenced = False
    for number, line in enumerate(lines, 1):
        text = line
        if path.suffix == ".rs":
            comment = COMMENT.match(line)
            if not comment:
                fenced = False
                continue
            text = comment[1]
        if text.lstrip().startswith(("```", "~~~")):
            fenced = not fenced
        elif not fenced:
            yield number, text, line


def may_be_longer(text):
    is_word = len(text.split()) == 1
    return is_word or text.startswith(("    ", "|", "#", "![")) or re.search(r"\S  +\S", text)


def main():
    listed = subprocess.run(
        ["git", "ls-files", "*.rs", "*.md"], check=True, stdout=subprocess.PIPE, text=True
    )
    findings = [
        f"{path}:{number} has {len(line)} columns, must have at most {COLUMNS}"
        for path in map(Path, listed.stdout.splitlines())
        for number, text, line in prose(path, path.read_text().splitlines())
        if len(line) > COLUMNS and not may_be_longer(text)
    ]
    for finding in findings:
        print(finding)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
