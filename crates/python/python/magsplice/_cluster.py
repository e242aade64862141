"""Work on the workers of a Dask client."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import numpy as np

from magsplice._layout import Floats

Result = TypeVar("Result")

#: Number of tasks for each thread of the workers, so that all end at about the same time.
_TASKS_PER_THREAD = 8
#: Largest number of samples of a task: a few seconds of the published film, lost with a worker.
_MOST_PER_TASK = 10_000


def samples(
    client: Any,
    draw: Callable[[int, int], Floats],
    first: int,
    count: int,
    partition: int | None,
    progress: Callable[[int, int], Any] | None,
) -> Floats:
    """Errors of samples in the order of their numbers, computed in tasks of `partition` samples.

    `draw` takes the number of the first sample of a task and their count.
    """
    from distributed import as_completed

    if partition is None:
        slots = max(1, sum(client.nthreads().values()))
        partition = min(_MOST_PER_TASK, max(1, -(-count // (slots * _TASKS_PER_THREAD))))
    counts = {}
    for start in range(first, first + count, partition):
        size = min(partition, first + count - start)
        # The film is in every task, so no worker holds data of other workers. Tasks are not
        # declared pure, so equal calls are computed again.
        counts[client.submit(draw, start, size, pure=False)] = size
    futures = list(counts)
    try:
        if progress is not None:
            done = 0
            for future in as_completed(futures):
                done += counts[future]
                progress(done, count)
        parts: list[Floats] = client.gather(futures)
    except BaseException:
        client.cancel(futures)
        raise
    return np.concatenate(parts)


def gathered(client: Any, calls: Iterable[Callable[[], Result]]) -> list[Result]:
    """Results of calls, one task each."""
    futures = [client.submit(call, pure=False) for call in calls]
    try:
        found: list[Result] = client.gather(futures)
    except BaseException:
        client.cancel(futures)
        raise
    return found
