#!/usr/bin/env python3
"""Fails when one crate holds more than a quarter of the workspace's lines of Rust."""

import json
import subprocess
import sys
from pathlib import Path

LARGEST_SHARE = 0.25


def main():
    command = ["cargo", "metadata", "--no-deps", "--format-version", "1"]
    metadata = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    packages = metadata["packages"]
    folders = {Path(package["manifest_path"]).parent: package["name"] for package in packages}
    lines = dict.fromkeys(folders.values(), 0)
    for folder, name in folders.items():
        for file in folder.rglob("*.rs"):
            owner = next(parent for parent in file.parents if parent in folders)
            if owner == folder:
                lines[name] += len(file.read_text().splitlines())
    total = sum(lines.values())
    for name, count in sorted(lines.items(), key=lambda entry: -entry[1]):
        mark = f"  more than {LARGEST_SHARE:.0%}" if count > LARGEST_SHARE * total else ""
        print(f"{name:20} {count:6} lines {count / total:6.1%}{mark}")
    return 1 if total == 0 or max(lines.values()) > LARGEST_SHARE * total else 0


if __name__ == "__main__":
    sys.exit(main())
