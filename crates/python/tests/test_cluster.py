"""Samples and searches on the workers of a Dask client."""

import os
import signal

import numpy as np
import pytest
from test_results import SQUARES

import magsplice
from magsplice import Film

distributed = pytest.importorskip("distributed")

ARRAYS = ("uniformity_rmse", "displacement_rmse_mm", "amplitude")


@pytest.fixture(scope="module")
def client():
    """Client of two worker processes of one thread each, restarted when they die."""
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def same(found, expected):
    """Whether two results have the same bits."""
    return all(np.array_equal(getattr(found, a), getattr(expected, a)) for a in ARRAYS)


def test_two_workers_give_the_bits_of_one_process(client, published):
    expected = published.tolerance(300, preset="workshop", first=5)
    told = []
    found = published.tolerance(
        300,
        preset="workshop",
        first=5,
        client=client,
        partition=37,
        progress=lambda done, of: told.append((done, of)),
    )
    assert same(found, expected)
    assert len(told) == 9
    assert told[-1] == (300, 300)
    assert same(published.tolerance(300, preset="workshop", first=5, client=client), expected)


def test_layouts_with_errors_of_their_own_give_the_same_bits(client, published):
    film = published.replace(
        tolerance={
            "position_mm": {"uniform": 0.07},
            "rotation_deg": {"normal": 0.3, "within": 0.7},
            "direction_deg": 0.9,
            "stray_field": {"any_direction_ut": {"fixed": 50}},
            "samples": 60,
            "seed": 7,
        }
    )
    assert same(film.tolerance(client=client, partition=11), film.tolerance())


def test_a_worker_that_is_killed_halfway_changes_no_bit(client, published):
    samples = 1500
    expected = published.tolerance(samples, preset="workshop")
    before = client.run(os.getpid)
    killed = []

    def kill(done, of):
        if not killed and done >= of // 2:
            killed.append(next(iter(before.values())))
            os.kill(killed[0], signal.SIGKILL)

    found = published.tolerance(
        samples, preset="workshop", client=client, partition=50, progress=kill
    )
    assert same(found, expected)
    client.wait_for_workers(2)
    after = set(client.run(os.getpid).values())
    assert killed[0] not in after


def test_fronts_on_workers_are_those_of_one_process(client):
    film = Film.from_dict(SQUARES)
    found, expected = film.front([0.3, 0.5], client=client), film.front([0.3, 0.5])
    assert [d.film.to_toml() for d in found.designs] == [d.film.to_toml() for d in expected.designs]


def test_errors_on_workers_are_raised_here(client, published):
    broken = published.replace(tolerance={"size_mm": 0.3})
    with pytest.raises(magsplice.MagspliceError, match=r"sample .* errors is invalid"):
        broken.tolerance(100, client=client)
