"""The five lines of the README, in an environment with only the wheel."""

from pathlib import Path

import magsplice

film = magsplice.load(Path(__file__).parents[3] / "layouts" / "published-film.toml")
print("B at (0, 0, -5) mm:", film.b([0.0, 0.0, -5.0]), "T")
print("amplitude:", round(film.compare().amplitude, 6))
print("uniformity RMSE:", film.decouple().uniformity_rmse)

assert round(film.compare().amplitude, 6) == 0.818730
assert [round(value, 6) for value in film.decouple().uniformity_rmse] == [
    0.062872,
    0.062872,
    0.039888,
]
