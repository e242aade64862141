"""Ctrl-C, and other threads during work."""

import _thread
import threading

import numpy as np
import pytest
from test_results import SQUARES

import magsplice
from magsplice import Film

#: Seconds before Ctrl-C: long after the call has begun, and long before its work could end.
DELAY = 0.5


def interrupted(work):
    """Checks that Ctrl-C ends long work, and that Python runs meanwhile."""
    ticks = 0
    stop = threading.Event()

    def tick():
        nonlocal ticks
        while not stop.wait(0.01):
            ticks += 1

    ticker = threading.Thread(target=tick)
    timer = threading.Timer(DELAY, _thread.interrupt_main)
    ticker.start()
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            work()
    finally:
        timer.cancel()
        stop.set()
        ticker.join()
    # Without the interpreter released there would be hardly any.
    assert ticks > 5


def test_fields_are_interrupted(large):
    points = np.random.default_rng(7).uniform((-40, -40, -5), (40, 40, -3), (8_000_000, 3))
    interrupted(lambda: large.b(points))


def test_fields_of_grids_to_a_tolerance_are_interrupted(large):
    # Across the tiles, so most points are summed over a tree.
    grid = magsplice.Grid((-40, -40, -3), (40, 40, 4), (400, 400, 60))
    interrupted(lambda: large.b(grid, within=1e-9, invalid="nan"))


def test_gradients_are_interrupted(large):
    points = np.random.default_rng(7).uniform((-40, -40, -5), (40, 40, -3), (2_000_000, 3))
    interrupted(lambda: large.gradient(points))


def test_samples_are_interrupted(published):
    interrupted(lambda: published.tolerance(10_000_000, preset="workshop"))


def test_polarizations_are_interrupted(large):
    film = large.replace(material={"recoil_permeability": 1.1, "recoil_error": 1e-3})
    interrupted(lambda: film.b([0, 0, -4]))


def test_forces_are_interrupted(large):
    film = large.replace(material={"recoil_permeability": 1.1})
    # The polarization of the film is already known.
    film.b([0, 0, -4])
    interrupted(film.forces)


def test_budgets_are_interrupted(published):
    interrupted(lambda: published.budget(1_000_000, preset="by-hand"))


def test_checks_are_interrupted(published):
    made = {"samples": 1_000_000, "displacement_rmse_mm": {"x": 1}}
    interrupted(published.replace(tolerance={"preset": "workshop"}, expect={"made": made}).check)


def test_searches_are_interrupted(published):
    design = {"vary": ["size", "position", "direction"], "symmetry": "mirror", "starts": 10_000}
    interrupted(published.replace(design=design).design)


def test_exceptions_in_callbacks_end_the_work(published):
    def refuse(*_):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        published.tolerance(10_000_000, preset="workshop", progress=refuse)
    many = Film.from_dict({**SQUARES, "design": {**SQUARES["design"], "starts": 10_000}})
    with pytest.raises(RuntimeError, match="enough"):
        many.design(progress=refuse)
