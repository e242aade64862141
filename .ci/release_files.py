#!/usr/bin/env python3
"""Fails when the files of a release contradict each other, or break a rule that no schema knows.

1. Cargo.toml, CITATION.cff and codemeta.json have one version and one licence.
2. Every action is pinned by a full commit hash, with its version in a comment, and one action has
   one hash. All workflows and the Dockerfile use one compiler. Wheels are built with the maturin of
   the tests. Every job has a limit of time.
3. release.yml builds the targets of dist-workspace.toml, with the same cargo-dist, and Cargo.toml has
   the profile that cargo-dist needs.
4. paper/paper.md has the length and the sections that JOSS asks for, and cites what is in paper.bib.
5. SKILL.md fits on three screens, and the links of llms.txt exist.

It needs ruamel.yaml, which check-jsonschema brings.
"""

import json
import re
import sys
import tomllib
from pathlib import Path

from ruamel.yaml import YAML

WORKFLOWS = Path(".github/workflows")
PAPER_WORDS = range(250, 1001)
PAPER_SECTIONS = ["Summary", "Statement of need", "State of the field", "Functionality"]
PAPER_SECTIONS += ["Accuracy and speed", "References"]
SKILL_LINES = 150


def yaml(path):
    return YAML(typ="safe").load(path.read_text())


def versions():
    package = tomllib.loads(Path("Cargo.toml").read_text())["workspace"]["package"]
    citation = yaml(Path("CITATION.cff"))
    codemeta = json.loads(Path("codemeta.json").read_text())
    licences = package["license"].split(" OR ")
    for name, version, found in [
        ("CITATION.cff", citation["version"], citation["license"]),
        (
            "codemeta.json",
            codemeta["version"],
            [url.rsplit("/")[-1] for url in codemeta["license"]],
        ),
    ]:
        if version != package["version"]:
            yield f"{name} has version {version}, Cargo.toml {package['version']}"
        if found != licences:
            yield f"{name} has the licences {found}, Cargo.toml {licences}"


def actions():
    hashes, compilers = {}, {}
    for path in sorted(WORKFLOWS.glob("*.yml")):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            used = re.match(r"\s*(?:- )?uses: (\S+)(.*)", line)
            if not used or used[1].startswith("./"):
                continue
            action, _, commit = used[1].partition("@")
            if not re.fullmatch(r"[0-9a-f]{40}", commit):
                yield f"{path}:{number}: {action} is not pinned by a commit"
            if not re.fullmatch(r" # v\d+\.\d+\.\d+", used[2]):
                yield f"{path}:{number}: {action} has no version in a comment"
            if hashes.setdefault(action, commit) != commit:
                yield f"{path}:{number}: {action} has another commit elsewhere"
        workflow = yaml(path)
        compilers[path] = workflow.get("env", {}).get("RUST_VERSION")
        for name, job in workflow["jobs"].items():
            if "uses" not in job and "timeout-minutes" not in job:
                yield f"{path}: the job {name} has no limit of time"
    image = re.search(r"^FROM rust:([\d.]+)-", Path("Dockerfile").read_text(), re.MULTILINE)
    compilers["Dockerfile"] = image and image[1]
    if len(set(compilers.values())) != 1 or None in compilers.values():
        yield "compilers differ: " + ", ".join(
            f"{path} {found}" for path, found in compilers.items()
        )


def wheels():
    requirements = Path("crates/python/tests/requirements.txt").read_text()
    tested = re.search(r"^maturin==(\S+)$", requirements, re.MULTILINE)[1]
    for version in re.findall(r"maturin-version: v(\S+)", (WORKFLOWS / "wheels.yml").read_text()):
        if version != tested:
            yield f"wheels.yml has maturin {version}, the tests of the package {tested}"


def binaries():
    workflow = yaml(WORKFLOWS / "release.yml")
    dist = tomllib.loads(Path("dist-workspace.toml").read_text())["dist"]
    entries = workflow["jobs"]["binaries"]["strategy"]["matrix"]["include"]
    built = {entry["target"] for entry in entries}
    if built != set(dist["targets"]):
        yield f"release.yml and dist-workspace.toml differ in {built ^ set(dist['targets'])}"
    if "dist" not in tomllib.loads(Path("Cargo.toml").read_text())["profile"]:
        yield "Cargo.toml has no profile dist, with which cargo-dist builds"
    if workflow["env"]["DIST_VERSION"] != dist["cargo-dist-version"]:
        yield "release.yml and dist-workspace.toml differ in the version of cargo-dist"


def paper():
    text = Path("paper/paper.md").read_text()
    _, _, body = text.removeprefix("---\n").partition("\n---\n")
    words = len(re.findall(r"[^\s|#-]\S*", body))
    if words not in PAPER_WORDS:
        yield f"paper.md has {words} words"
    sections = re.findall(r"^# (.*)$", body, re.MULTILINE)
    yield from (
        f"paper.md lacks the section {name}" for name in PAPER_SECTIONS if name not in sections
    )
    entries = set(
        re.findall(r"^@\w+\{([\w-]+),", Path("paper/paper.bib").read_text(), re.MULTILINE)
    )
    cited = set(re.findall(r"@([\w-]+)", body))
    yield from (f"paper.md and paper.bib differ in {key}" for key in sorted(cited ^ entries))


def assistants():
    lines = len(Path("SKILL.md").read_text().splitlines())
    if lines > SKILL_LINES:
        yield f"SKILL.md has {lines} lines"
    links = re.findall(r"\]\(([^)\s]+)\)", Path("llms.txt").read_text())
    yield from (
        f"llms.txt: {link}: there is no such file" for link in links if not Path(link).exists()
    )
    if not links:
        yield "llms.txt has no link"


def main():
    findings = [*versions(), *actions(), *wheels(), *binaries(), *paper(), *assistants()]
    for finding in findings:
        print(finding)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
