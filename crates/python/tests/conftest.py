"""Films of the repository, for all tests."""

from pathlib import Path

import pytest

import magsplice

LAYOUTS = Path(__file__).parents[3] / "layouts"


@pytest.fixture(scope="session")
def published() -> magsplice.Film:
    """The film of Dai 2024, 56 tiles, with a perfect sensor and without an elastic layer."""
    film = magsplice.load(LAYOUTS / "published-film.toml")
    return film.replace(sensor=None, elastomer=None)


@pytest.fixture(scope="session")
def large() -> magsplice.Film:
    """A film of 800 tiles."""
    return magsplice.load(LAYOUTS / "film-80mm.toml")
