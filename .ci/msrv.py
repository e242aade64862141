#!/usr/bin/env python3
"""Fails when a locked dependency asks for a newer compiler than the workspace says it needs.

All crates of the workspace must state the same `rust-version`, and README.md must name it.
"""

import json
import re
import subprocess
import sys
from pathlib import Path


def version(text):
    """`1.90` and `1.90.0` as the same tuple."""
    return tuple(([int(part) for part in text.split(".")] + [0, 0])[:3])


def main():
    command = ["cargo", "metadata", "--locked", "--format-version", "1"]
    metadata = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    own = [package for package in metadata["packages"] if package["source"] is None]
    stated = {package["rust_version"] for package in own}
    if len(stated) != 1 or None in stated:
        print(f"the crates of the workspace state different compilers: {stated}")
        return 1
    ours = stated.pop()
    findings = [
        f"{package['name']} {package['version']} asks for Rust {package['rust_version']}"
        for package in metadata["packages"]
        if package["rust_version"] and version(package["rust_version"]) > version(ours)
    ]
    readme = (Path(metadata["workspace_root"]) / "README.md").read_text()
    named = set(re.findall(r"Rust (1\.\d+)", readme))
    if named != {ours}:
        findings.append(f"README.md names {sorted(named) or 'no compiler'}")
    print("\n".join(findings) or f"{len(metadata['packages'])} packages build with Rust {ours}")
    if findings:
        print(f"rust-version in Cargo.toml is {ours}")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
