"""Types of the extension module. The package re-exports the public part."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import Self, disjoint_base

__all__ = [
    "Film",
    "Scene",
    "__version__",
    "assign",
    "budget",
    "c_header",
    "calibrate",
    "check",
    "compare",
    "decouple",
    "design",
    "diagnose",
    "experiment",
    "forces",
    "grid_axes",
    "ideal_film_figures",
    "joined",
    "layout_figure",
    "layout_svg",
    "layout_text",
    "live_page",
    "moved",
    "parts",
    "pattern",
    "read",
    "recoil",
    "recoil_estimate",
    "remark_on_range",
    "report",
    "resolution",
    "rotated",
    "run_program",
    "sample",
    "sampled",
    "samples",
    "scan",
    "selected",
    "shifted",
    "statistics",
    "view",
]

__version__: str

_Floats = NDArray[np.float64]
_Vector = tuple[float, float, float]
#: A fraction, a text, or an error in tesla.
_Within = float | str | tuple[float] | None
_Quantity = Literal["b", "h", "j"]
#: Keys of JSON with their values.
_Result = dict[str, Any]

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

@disjoint_base
class Film:
    def __new__(
        cls, text: str, origin: str, folder: str | os.PathLike[str] | None = None
    ) -> Self: ...
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
    def __len__(self) -> int: ...
    def to_toml(self, *, compact: bool = True) -> str: ...
    @property
    def _source(self) -> tuple[str, str, str | None]: ...
    @property
    def _scene(self) -> Scene: ...
    @property
    def _ideal(self) -> _Vector | None: ...
    @property
    def _volume(
        self,
    ) -> (
        tuple[_Vector, _Vector, tuple[int, int, int], _Vector, _Vector, _Vector, _Vector] | None
    ): ...
    @property
    def _head(
        self,
    ) -> tuple[str | None, float | None, list[_Vector], list[_Vector]] | None: ...
    @property
    def _has_default_reference(self) -> bool: ...
    @property
    def _sampling(self) -> tuple[int, int]: ...
    @property
    def _baseline_file(self) -> Path | None: ...
    def _tiles(
        self,
    ) -> tuple[list[str], list[str | None], _Floats, _Floats, _Floats, _Floats, _Floats]: ...
    def _blocks(self) -> tuple[list[str], _Floats, _Floats, _Floats, _Floats]: ...
    def _outlines(self) -> tuple[list[_Floats], _Floats, _Floats]: ...
    def _ideal_b(self, points: _Floats) -> _Floats: ...
    def _is_same(self, other: Film) -> bool: ...
    def _to_json(self) -> str: ...

def grid_axes(
    lower: _Vector, upper: _Vector, counts: tuple[int, int, int]
) -> tuple[_Floats, _Floats, _Floats]: ...
def shifted(values: _Floats, exponent: int) -> _Floats: ...
def layout_text(path: str | os.PathLike[str]) -> str: ...
def compare(film: Film, points: _Floats | None, within: _Within) -> _Result: ...
def decouple(film: Film, points: _Floats | None, within: _Within) -> tuple[_Result, _Result]: ...
def check(film: Film, baseline: tuple[_Floats, _Floats] | str | None = None) -> _Result: ...
def recoil(film: Film) -> tuple[_Result, _Result] | None: ...
def recoil_estimate(film: Film, mu_r: float) -> _Result | None: ...
def samples(
    film: Film,
    preset: str | None,
    seed: int,
    first: int,
    count: int,
    threads: int | None = None,
    progress: Callable[[int, int], Any] | None = None,
) -> _Floats: ...
def sampled(film: Film, preset: str | None, seed: int, first: int, errors: _Floats) -> _Result: ...
def statistics(values: _Floats) -> _Result | None: ...
def budget(film: Film, preset: str | None, seed: int, samples: int) -> _Result: ...
def forces(
    film: Film, turned_error: float, order: str | list[int] | None, seed: int
) -> _Result: ...
def remark_on_range(film: Film, points: _Floats, readings_t: _Floats) -> str | None: ...
def read(
    film: Film,
    readings_t: _Floats,
    noise_t: _Vector | None,
    constant_t: _Vector,
    at_rest: tuple[_Floats | None, _Floats | None],
    fit: tuple[str, int] | None,
) -> tuple[tuple[_Result, _Result], list[str]]: ...
def calibrate(
    film: Film,
    forces_n: _Floats,
    readings_t: _Floats,
    constant_t: _Vector,
    zero_t: _Floats | None,
    rest_t: _Floats | None,
) -> tuple[tuple[_Result, _Result], list[str]]: ...
def scan(
    film: Film, points: _Floats, readings_t: _Floats, fit: list[str] | None
) -> tuple[tuple[_Result, _Result], dict[str, tuple[list[str], _Floats]], list[str]]: ...
def sample(
    film: Film, preset: str | None, seed: int, index: int, points: _Floats
) -> tuple[tuple[_Result, _Result], str]: ...
def resolution(film: Film, points: _Floats, noise_t: _Vector | None) -> _Floats | None: ...
def assign(
    film: Film,
    measured: list[tuple[str, str | None, _Vector | None, list[float]]],
    placed: list[tuple[str, str, _Vector | None, str, float]],
    shims: list[str],
    may_turn_over: bool,
    starts: int | None,
    seed: int,
    errors: tuple[float, float, float | None] | None,
) -> tuple[_Result, str]: ...
def diagnose(
    film: Film,
    points: _Floats,
    readings_t: _Floats,
    noise_t: _Vector | None,
    preset: str | None,
    as_ordered: bool,
    fit: list[str],
    false_alarm: float,
) -> tuple[tuple[_Result, dict[str, _Floats]], list[str]]: ...
def design(
    film: Film,
    least_amplitude: float | None,
    is_spliced: bool,
    progress: Callable[[str, int, int, float | None], Any] | None,
) -> tuple[_Result, str]: ...
def report(
    film: Film,
    json: str,
    outlines: bool,
    within: _Within,
    baseline: tuple[_Floats, _Floats] | str | None = None,
) -> tuple[list[tuple[str, str, str, bytes, str]], list[str], list[str]]: ...
def view(film: Film) -> str: ...
def live_page(film: Film, text: str, engine: bytes | None = None) -> str | None: ...
def layout_figure(film: Film) -> tuple[str, str, str, bytes, str]: ...
def ideal_film_figures(film: Film) -> list[tuple[str, str, str, bytes, str]]: ...
def layout_svg(film: Film) -> str: ...
def moved(film: Film, shift_mm: _Vector) -> str: ...
def rotated(film: Film, rotation: dict[str, Any], about_mm: _Vector) -> str: ...
def selected(film: Film, indices: list[int]) -> str: ...
def joined(film: Film, other: Film) -> str: ...
def parts(film: Film, kerf_mm: float | None) -> _Result: ...
def c_header(film: Film, error_mm: float) -> str: ...
def experiment(
    film: Film,
    step_mm: _Vector,
    seed: int | None,
    shift_mm: _Vector,
    rotation_deg: _Vector,
    bend: tuple[int, float] | _Floats | None,
) -> tuple[_Result, dict[str, tuple[list[str], _Floats]]]: ...
def pattern(
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
    preset: str | None,
    under: str,
    one_sided: bool,
    sensor: str | None,
    name: str | None,
) -> str: ...
def run_program(arguments: list[str]) -> int: ...
