"""Types of the extension module. The package re-exports what people use."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, final

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "Film",
    "Scene",
    "__version__",
    "assign",
    "baseline_file",
    "budget",
    "check",
    "compare",
    "decouple",
    "design",
    "diagnose",
    "forces",
    "layout_svg",
    "nominal",
    "read",
    "recoil",
    "recoil_estimate",
    "report",
    "resolution",
    "samples",
    "splice",
    "statistics",
    "view",
]

__version__: str

_Floats = NDArray[np.float64]
_Vector = tuple[float, float, float]
_Within = tuple[bool, float] | None
_Quantity = Literal["b", "h", "j"]
_Errors = tuple[_Floats, _Floats, _Floats]

@final
class Scene:
    def __new__(
        cls, position: _Floats, size: _Floats, polarization_t: _Floats, rotation: _Floats
    ) -> Scene: ...
    def __len__(self) -> int: ...
    def field(
        self, quantity: _Quantity, points: _Floats, within: _Within = None
    ) -> tuple[_Floats, Exception | None]: ...
    def field_on_grid(
        self,
        quantity: _Quantity,
        lower: _Vector,
        upper: _Vector,
        counts: tuple[int, int, int],
        within: _Within = None,
    ) -> tuple[_Floats, Exception | None]: ...
    def gradient(
        self, quantity: _Quantity, points: _Floats
    ) -> tuple[_Floats, Exception | None]: ...
    def error_bounds_t(self, points: _Floats) -> _Floats: ...

@final
class Film:
    @staticmethod
    def read(path: str | os.PathLike[str]) -> Film: ...
    @staticmethod
    def parse(text: str, origin: str, folder: str | os.PathLike[str] | None = None) -> Film: ...
    @property
    def scene(self) -> Scene: ...
    @property
    def name(self) -> str: ...
    @property
    def description(self) -> str | None: ...
    @property
    def history(self) -> list[str]: ...
    @property
    def sha256(self) -> str: ...
    @property
    def findings(self) -> list[str]: ...
    @property
    def ideal(self) -> _Vector | None: ...
    @property
    def volume(
        self,
    ) -> (
        tuple[_Vector, _Vector, tuple[int, int, int], _Vector, _Vector, _Vector, _Vector] | None
    ): ...
    @property
    def sampling(self) -> tuple[int, int] | None: ...
    def __len__(self) -> int: ...
    def cells(self) -> tuple[list[int], _Floats, _Floats, _Floats, _Floats] | None: ...
    def tiles(
        self,
    ) -> tuple[list[str], list[str | None], _Floats, _Floats, _Floats, _Floats, _Floats]: ...
    def ideal_b(self, points: _Floats) -> _Floats: ...
    def to_json(self) -> str: ...
    def to_toml(self, compact: bool) -> str: ...

def assign(
    film: Film,
    measured: list[tuple[str, str | None, _Vector | None, list[float]]],
    placed: list[tuple[str, str, _Vector | None, str, float]],
    shims: list[str],
    may_turn_over: bool,
    starts: int,
    seed: int,
    errors: tuple[float, float, float | None] | None,
) -> dict[str, Any]: ...
def baseline_file(film: Film) -> Path | None: ...
def check(film: Film, baseline: tuple[_Floats, _Floats] | None = None) -> list[dict[str, Any]]: ...
def budget(film: Film, preset: str | None, seed: int, samples: int) -> dict[str, Any]: ...
def diagnose(
    film: Film,
    points: _Floats,
    readings_t: _Floats,
    noise_t: _Vector | None,
    preset: str | None,
    as_ordered: bool,
    free: list[bool],
    false_alarm: float,
) -> dict[str, Any]: ...
def recoil(film: Film) -> dict[str, Any] | None: ...
def recoil_estimate(film: Film, mu_r: float) -> dict[str, Any] | None: ...
def compare(
    film: Film, points: _Floats | None = None, within: _Within = None
) -> dict[str, Any]: ...
def decouple(
    film: Film, points: _Floats | None = None, within: _Within = None
) -> dict[str, Any]: ...
def forces(
    film: Film, turned_error: float, order: list[int] | None = None, seed: int | None = None
) -> dict[str, Any]: ...
def samples(
    film: Film,
    preset: str | None,
    seed: int,
    first: int,
    count: int,
    threads: int | None = None,
    progress: Callable[[int, int], Any] | None = None,
) -> _Errors: ...
def nominal(film: Film) -> _Errors: ...
def statistics(values: _Floats) -> dict[str, Any] | None: ...
def read(
    film: Film,
    readings_t: _Floats,
    noise_t: _Vector | None = None,
    constant_t: _Vector = ...,
    zero_t: _Floats | None = None,
    rest_t: _Floats | None = None,
) -> dict[str, Any]: ...
def resolution(film: Film, points: _Floats, noise_t: _Vector | None = None) -> _Floats | None: ...
def report(
    film: Film,
    text: str,
    json: str,
    outlines: bool = False,
    within: _Within = None,
) -> tuple[list[tuple[str, str, str, bytes, str]], str, list[str]]: ...
def view(film: Film) -> str: ...
def layout_svg(film: Film) -> str: ...
def design(
    film: Film,
    least_amplitude: float | None = None,
    progress: Callable[[str, int, int, float | None], Any] | None = None,
) -> dict[str, Any]: ...
def splice(
    wavelength_mm: float,
    film_mm: tuple[float, float],
    thickness_mm: float | None,
    remanence_t: float,
    range_mm: tuple[float, float] | None,
    distance_mm: tuple[float, float] | None,
    smallest_cut_mm: float | None,
    gap_mm: float,
    resolution_mm: float,
    resolution_deg: float,
    least_amplitude: float,
    parts: int | None,
    goal: str,
    starts: int,
    seed: int,
) -> str: ...
