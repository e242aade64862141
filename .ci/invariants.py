#!/usr/bin/env python3
"""Fails when an invariant of ARCHITECTURE.md does not hold that a look at the text can refute.

1. Only `layout` knows TOML: no other crate depends on a TOML parser, but for its tests, and no text
   in other crates writes tables of a layout file.
2. `cli` converts no units: outside of the two files that name units, its code has no factor between
   units and no conversion of angles.
"""

import re
import sys
import tomllib
from pathlib import Path

#: Crates that know TOML.
KNOW_TOML = {"layout"}
#: Crates of the program that read or write TOML.
PARSERS = re.compile(r"toml(_\w+)?$")

#: Files of the program that convert units: of texts that people type, and of values that it shows.
UNIT_FILES = {"units.rs", "text/units.rs"}
#: Names and factors of conversions.
CONVERSIONS = re.compile(
    r"\bto_degrees\b|\bto_radians\b|\b[A-Z]+_PER_[A-Z0-9]+\b|\bwavenumber\b|\bas_lengths\b"
    r"|(?<![\w.])(?:1(?:\.0)?e-?[369]|1_?000(?:\.0)?|100\.0)(?:_f64)?\s*[*/]"
    r"|[*/]\s*(?:1(?:\.0)?e-?[369]|1_?000(?:\.0)?|100\.0)(?:_f64)?(?![\w.])"
)

#: The head of a table, or the first key of a layout, on a line of its own.
TABLE = re.compile(r"(?:^|\n)[ \t]*(?:\[\[?[a-z_.]+\]\]?[ \t]*\n|format = )")

COMMENT = re.compile(r"//[^\n]*")
STRING = re.compile(r'r#"(.*?)"#|"((?:[^"\\]|\\.)*)"', re.DOTALL)


def code_of(path):
    """The code of a file without its tests."""
    text = path.read_text()
    return re.split(r"\n#\[cfg\(test\)\]\n", text)[0]


def is_test(path):
    return path.name.endswith("tests.rs") or "tests" in path.parts


def strings(code):
    """The number of the line and the text of each literal, with its escapes replaced."""
    without_comments = re.sub(r"(?m)^\s*//[^\n]*", "", code)
    for found in STRING.finditer(without_comments):
        text = found[1] if found[1] is not None else re.sub(r"\\\n\s*", "", found[2])
        if found[1] is None:
            text = text.replace("\\n", "\n").replace('\\"', '"')
        yield without_comments.count("\n", 0, found.start()) + 1, text


def sources(crate):
    return [path for path in sorted((crate / "src").rglob("*.rs")) if not is_test(path)]


def toml_outside_layout(crates):
    """What other crates than `layout` know of TOML."""
    for crate in crates:
        if crate.name in KNOW_TOML:
            continue
        manifest = tomllib.loads((crate / "Cargo.toml").read_text())
        targets = [manifest, *manifest.get("target", {}).values()]
        for kind in ("dependencies", "build-dependencies"):
            for name in (name for target in targets for name in target.get(kind, {})):
                if PARSERS.match(name):
                    yield f"{crate / 'Cargo.toml'}: {kind} has {name}, which only layout may have"
        for path in sources(crate):
            for line, text in strings(code_of(path)):
                if TABLE.search(text):
                    yield f"{path}:{line}: writes a table of a layout file, which only layout may"


def conversions_in(program):
    """Conversions of units in the crate of the program."""
    for path in sources(program):
        if str(path.relative_to(program / "src")) in UNIT_FILES:
            continue
        for number, line in enumerate(code_of(path).splitlines(), 1):
            code = STRING.sub('""', COMMENT.sub("", line))
            if found := CONVERSIONS.search(code):
                yield f"{path}:{number}: {found[0].strip()} converts a unit, which text/units.rs does"


def main():
    crates = sorted(path.parent for path in Path("crates").glob("*/Cargo.toml"))
    findings = [*toml_outside_layout(crates), *conversions_in(Path("crates/cli"))]
    for finding in findings:
        print(finding)
    return 1 if findings or not crates else 0


if __name__ == "__main__":
    sys.exit(main())
