#!/usr/bin/env python3
"""Packages every crate that can be published, and builds the library crates from the packages.

Nothing is uploaded. The packages are unpacked into a workspace of their own below target/, so that
a file that is missing from a package, or a path that leaves it, fails here.
"""

import json
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

REQUIRED = ["description", "license", "readme", "keywords", "categories", "rust_version"]
FILES = {"README.md", "LICENSE-MIT", "LICENSE-APACHE"}


def main():
    command = ["cargo", "metadata", "--no-deps", "--format-version", "1"]
    metadata = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    published = [package for package in metadata["packages"] if package["publish"] != []]
    others = [package["name"] for package in metadata["packages"] if package["publish"] == []]
    findings = [
        f"{package['name']}: {key} is missing in Cargo.toml"
        for package in published
        for key in REQUIRED
        if not package[key]
    ]
    findings += [
        f"{package['name']}: [package.metadata.docs.rs] is missing in Cargo.toml"
        for package in published
        if not ((package["metadata"] or {}).get("docs") or {}).get("rs")
    ]
    # The steps below are offline: no registry is asked for our own names.
    subprocess.run(["cargo", "fetch", "--locked", "--quiet"], check=True)
    excluded = [word for name in others for word in ("--exclude", name)]
    command = ["cargo", "package", "--workspace", *excluded, "--locked", "--offline", "--no-verify"]
    # A working tree with changes is packaged too. CI packages a clean clone.
    subprocess.run([*command, "--quiet", "--allow-dirty", "--no-metadata"], check=True)

    target = Path(metadata["target_directory"])
    unpacked = target / "package" / "unpacked"
    shutil.rmtree(unpacked, ignore_errors=True)
    members, patches = [], []
    for package in published:
        name = f"{package['name']}-{package['version']}"
        with tarfile.open(target / "package" / f"{name}.crate") as archive:
            archive.extractall(unpacked, filter="data")
        # Cargo compares times, and files in packages have a fixed one.
        for file in (unpacked / name).rglob("*.rs"):
            file.touch()
        missing = FILES - {file.name for file in (unpacked / name).iterdir()}
        findings += [f"{name}: {file} is missing in the package" for file in sorted(missing)]
        members.append(f'"{name}"')
        patches.append(f'{package["name"]} = {{ path = "{name}" }}\n')
    manifest = f'[workspace]\nresolver = "3"\nmembers = [{", ".join(members)}]\n'
    (unpacked / "Cargo.toml").write_text(manifest + "[patch.crates-io]\n" + "".join(patches))
    shutil.copy(Path(metadata["workspace_root"]) / "Cargo.lock", unpacked)
    command = ["cargo", "check", "--workspace", "--offline", "--target-dir", str(target)]
    if subprocess.run(command, cwd=unpacked, check=False).returncode != 0:
        findings.append("the packages do not build by themselves")
    print("\n".join(findings) or f"{len(published)} packages are complete and build by themselves")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
