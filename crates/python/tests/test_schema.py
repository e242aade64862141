"""The JSON Schema of layout files against the files."""

import copy
import json
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import tomli_w
import tomllib
from conftest import LAYOUTS
from test_keys import PROGRAM

import magsplice

EVERY_KEY = tomllib.loads((LAYOUTS / "../tests/film/every_key.toml").read_text())


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def validator() -> jsonschema.Draft202012Validator:
    schema = json.loads(run("schema").stdout)
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def documents() -> dict[str, dict[str, Any]]:
    """The shipped layouts, the commented layout of `init`, and one with every key."""
    shipped = {str(path): tomllib.loads(path.read_text()) for path in LAYOUTS.rglob("*.toml")}
    assert len(shipped) > 12
    return shipped | {"init": tomllib.loads(run("init", "-").stdout), "every key": EVERY_KEY}


# The layout with every key is no sensible film.
@pytest.mark.filterwarnings("ignore::magsplice.LayoutWarning")
def test_layouts_and_their_plain_forms_match_the_schema(
    validator: jsonschema.Draft202012Validator,
) -> None:
    for name, document in documents().items():
        film = magsplice.Film.from_dict(document, folder=LAYOUTS)
        for form in [document, film.to_dict()]:
            errors = [
                f"{error.json_path}: {error.message}" for error in validator.iter_errors(form)
            ]
            assert errors == [], name


def tables(value: object, at: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """The places of all tables of a document."""
    if isinstance(value, dict):
        yield at
        yield from (found for key, inner in value.items() for found in tables(inner, (*at, key)))
    elif isinstance(value, list):
        yield from (found for key, inner in enumerate(value) for found in tables(inner, (*at, key)))


def at(document: Any, place: tuple[str | int, ...]) -> Any:
    for key in place:
        document = document[key]
    return document


WRONG_TYPES: list[tuple[tuple[str | int, ...], Any]] = [
    (("format",), 2),
    (("name",), 3),
    (("tile", 0, "position_mm"), [1, 2]),
    (("tile", 0, "grid", "count"), [1, -2, 1]),
    (("tile", 0, "mirror", "axes"), ["w"]),
    (("tile", 0, "mirror", "polarization"), "kept"),
    (("volume", "step_mm"), "fine"),
    (("lattice", 0, "x", 0, "times"), 1.5),
    (("tolerance", "position_mm", 0), "small"),
    (("tolerance", "position_mm", 1), {"normal": "much"}),
    (("tolerance", "size_mm"), {"values": 1}),
    (("tolerance", "group", 0, "rows_along"), "w"),
    (("tolerance", "stray_field", "when"), "later"),
    (("tolerance", "samples"), -1),
    (("expect", "made", "percentile"), "most"),
    (("design", "under"), "errors"),
]

REQUIRED: list[tuple[str | int, ...]] = [
    ("format",),
    ("name",),
    ("tile", 0, "position_mm"),
    ("expect", "field", "within"),
]


def test_schema_and_program_refuse_the_same_documents(
    validator: jsonschema.Draft202012Validator, tmp_path: Path
) -> None:
    """An unknown key in any table, a wrong type, a missing key."""
    wrong: dict[tuple[str | int, ...], dict[str, Any]] = {}
    # A kind may have any name.
    places = [place for place in tables(EVERY_KEY) if place != ("kind",)]
    assert len(places) > 20
    for place in places:
        wrong[(*place, "colour")] = copy.deepcopy(EVERY_KEY)
        at(wrong[(*place, "colour")], place)["colour"] = "red"
    for place, value in WRONG_TYPES:
        wrong[place] = copy.deepcopy(EVERY_KEY)
        at(wrong[place], place[:-1])[place[-1]] = value
    for place in REQUIRED:
        wrong[(*place, "missing")] = copy.deepcopy(EVERY_KEY)
        del at(wrong[(*place, "missing")], place[:-1])[place[-1]]
    layout = tmp_path / "layout.toml"
    layout.write_text(tomli_w.dumps(EVERY_KEY))
    assert run("tiles", layout).returncode == 0
    for name, document in wrong.items():
        assert not validator.is_valid(document), f"the schema accepts {name}"
        layout.write_text(tomli_w.dumps(document))
        assert run("tiles", layout).returncode == 2, f"the program accepts {name}"
