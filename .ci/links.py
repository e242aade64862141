#!/usr/bin/env python3
"""Fails when a page links to a file or a heading that is not there, when ARCHITECTURE.md names a
path that is not there, or when it lacks a crate, a folder of sources or a tool that is there. A
folder that only holds the tests of the file beside it need not be on the map."""

import re
import subprocess
import sys
from pathlib import Path

MAP = "ARCHITECTURE.md"
LINK = re.compile(r"\]\(([^)\s]+)\)")
NAMED_PATH = re.compile(r"`((?:crates|docs|tools|tests|benches|layouts|\.ci)/[^`\s]*)`")


def anchors(page):
    headings = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def broken_links(page):
    for link in LINK.findall(page.read_text()):
        if re.match(r"\w+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = page.parent / path if path else page
        if not target.exists():
            yield f"{page}: {link}: there is no such file"
        elif anchor and anchor not in anchors(target):
            yield f"{page}: {link}: there is no such heading"


def map_faults(tracked):
    text = Path(MAP).read_text()
    for path in NAMED_PATH.findall(text):
        if not any(Path().glob(path.rstrip("/"))):
            yield f"{MAP}: {path}: there is no such file"
    for source in tracked:
        parts = Path(source).parts
        if source.endswith(".rs") and parts[0] in ("crates", "tools") and f"{parts[1]}/" not in text:
            yield f"{MAP} lacks {parts[0]}/{parts[1]}/"
        in_folder = parts[0] == "crates" and len(parts) > 4 and parts[2] == "src"
        if source.endswith(".rs") and in_folder and parts[-1] != "tests.rs":
            if f"{parts[3]}/" not in text:
                yield f"{MAP} lacks {'/'.join(parts[:4])}/"


def main():
    listed = subprocess.run(["git", "ls-files"], check=True, stdout=subprocess.PIPE, text=True)
    tracked = listed.stdout.splitlines()
    pages = [Path(name) for name in tracked if name.endswith(".md")]
    if not pages:
        sys.exit("found no page")
    faults = [fault for page in pages for fault in broken_links(page)]
    faults += sorted(set(map_faults(tracked)))
    for fault in faults:
        print(fault)
    sys.exit(1 if faults else 0)


main()
