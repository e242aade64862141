"""Samples and searches on the workers of a Dask client, which schedules them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from magsplice import _magsplice

if TYPE_CHECKING:
    from magsplice._film import Film
    from magsplice._layout import Floats
    from magsplice._results import Design

#: Tasks for each thread of the workers, so that all end at about the same time.
_TASKS_PER_THREAD = 8
#: Most samples of a task: a few seconds for the published film, which is lost with a worker.
_MOST_PER_TASK = 10_000


def samples(
    client: Any,
    film: Film,
    preset: str | None,
    seed: int,
    first: int,
    count: int,
    threads: int,
    partition: int | None,
    progress: Callable[[int, int], Any] | None,
) -> tuple[Floats, Floats, Floats]:
    """Errors of samples in the order of their numbers, computed in tasks of `partition` samples."""
    from distributed import as_completed

    if partition is None:
        slots = max(1, sum(client.nthreads().values()))
        partition = min(_MOST_PER_TASK, max(1, -(-count // (slots * _TASKS_PER_THREAD))))
    counts = {}
    for start in range(first, first + count, partition):
        size = min(partition, first + count - start)
        # The film is in every task, so that no worker holds what others need. A task is not called
        # pure, so that equal calls are computed again.
        future = client.submit(_samples, film, preset, seed, start, size, threads, pure=False)
        counts[future] = size
    futures = list(counts)
    try:
        if progress is not None:
            done = 0
            for future in as_completed(futures):
                done += counts[future]
                progress(done, count)
        parts = client.gather(futures)
    except BaseException:
        client.cancel(futures)
        raise
    if not parts:
        return np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0)
    uniformity, displacement, amplitude = zip(*parts, strict=True)
    return np.concatenate(uniformity), np.concatenate(displacement), np.concatenate(amplitude)


def designs(client: Any, film: Film, least_amplitudes: Sequence[float]) -> list[Design]:
    """Films found for each least amplitude, one task each."""
    futures = [client.submit(_design, film, float(least), pure=False) for least in least_amplitudes]
    try:
        found: list[Design] = client.gather(futures)
    except BaseException:
        client.cancel(futures)
        raise
    return found


def _samples(
    film: Film, preset: str | None, seed: int, first: int, count: int, threads: int
) -> tuple[Floats, Floats, Floats]:
    return _magsplice.samples(film._core, preset, seed, first, count, threads)


def _design(film: Film, least_amplitude: float) -> Design:
    return film.design(least_amplitude=least_amplitude)
