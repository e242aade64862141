"""Forked processes, whose parent has computed: the same numbers as in the parent."""

import multiprocessing
import os
import select
import signal
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

import magsplice

pytestmark = [
    pytest.mark.skipif(not hasattr(os, "fork"), reason="the system has no fork"),
    # Python 3.12 and later warn that other threads do not exist in the child.
    pytest.mark.filterwarnings("ignore:.*multi-threaded, use of fork:DeprecationWarning"),
]

#: Seconds until a child counts as hanging: many times as long as its work takes.
HANGING = 120
POINTS = np.random.default_rng(3).uniform((-2, -2, -5), (2, 2, -3), (5000, 3))


def numbers(film):
    """Numbers of every kind of work: fields, grids, samples, forces, pictures."""
    grid = magsplice.Grid((-2, -2, -5), (2, 2, -3), (20, 20, 10))
    return [
        film.b(POINTS).sum(),
        film.b(grid, within=1e-9).sum(),
        film.gradient(POINTS).sum(),
        film.error_bound(POINTS).sum(),
        film.decouple().displacement_rmse_mm.x,
        film.tolerance(20, preset="jig").amplitude.sum(),
        film.tolerance(20, preset="jig", threads=2).amplitude.sum(),
        film.budget(20, preset="jig").to_dict(),
        film.forces().to_dict(),
        len(film._repr_html_()),
    ]


def in_child(work):
    """Text that `work` returns in a forked child."""
    reads, writes = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.write(writes, work().encode())
        except BaseException as error:
            os.write(writes, repr(error).encode())
        finally:
            # Without the end of the tests, which the parent runs.
            os._exit(0)
    os.close(writes)
    if not select.select([reads], [], [], HANGING)[0]:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        pytest.fail(f"the child hangs for {HANGING} s")
    with os.fdopen(reads) as stream:
        found = stream.read()
    os.waitpid(child, 0)
    return found


def test_forked_children_have_the_numbers_of_the_parent(published):
    expected = repr(numbers(published))

    def grandchild():
        # The threads of the child do not exist in its own children either.
        return repr(published.b(POINTS).sum()) + in_child(lambda: repr(numbers(published)))

    assert in_child(grandchild) == repr(published.b(POINTS).sum()) + expected
    assert in_child(lambda: repr(published.tolerance(20, preset="jig").amplitude[3])) == repr(
        published.tolerance(20, preset="jig").amplitude[3]
    )


def test_pools_of_forked_processes_compute(published):
    expected = published.b(POINTS)
    pool = ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("fork"))
    try:
        calls = [pool.submit(published.b, POINTS) for _ in range(4)]
        for call in calls:
            assert np.array_equal(call.result(timeout=HANGING), expected)
    finally:
        for process in pool._processes.values():
            process.kill()
        pool.shutdown(cancel_futures=True)
