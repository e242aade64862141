"""Magnet films spliced from cuboids: exact field, decoupling, tolerances and design.

A spliced film is a flat magnet of many small, uniformly magnetized cuboids, its tiles. This package
computes its field, compares it with the ideal film, computes how well it decouples the three axes
of a tactile sensor below it, and searches for a better film.

Five lines::

    import magsplice
    film = magsplice.load("layouts/published-film.toml")
    print(film.b([0.0, 0.0, -5.0]))         # B in tesla at a point in millimetres
    print(film.compare().amplitude)         # against the ideal film
    print(film.decouple().uniformity_rmse)  # of R_x, R_y, S_z

Units and shapes
----------------
Lengths are in millimetres, flux density B and polarization J in tesla, field strength H in ampere
per metre, forces in newton, rotations in degrees. A name ends with its unit: ``_mm``, ``_t``,
``_n``, ``_deg``. Points and vectors have the shape (..., 3), with x, y, z last. Only `getB` and
`getH` use metres, like magpylib.

First steps
-----------
load, loads, Film
    A film from a file, from text or from tiles.
Film.moved, Film.rotated, ``film + film``, ``film[:10]``
    Films with other tiles.
splice, pattern
    A film designed from a few numbers, and the film from which this search starts.
Film.b, Film.h, Film.j, Film.gradient
    Its field at points or on a `Grid`, exact or within a tolerance.
Film.compare, Film.decouple
    The ideal film, and the decoupling parameters.
Film.check
    Expectations of the layout, and whether the film meets them.
Film.recoil
    How the field of the tiles changes their polarization.
Film.tolerance, Film.budget
    Films as made, on one machine or on a cluster, and the causes of their error.
Film.forces
    Forces of the tiles on each other, and placement orders.
Film.read, Film.resolution
    Displacements and forces from readings of a Hall sensor.
Film.head, Head
    Several sensors on one board, read as one.
Film.experiment, Film.c_header
    Readings of a sensor while the film moves, and a function for firmware.
Film.parts
    The bill of materials.
Film.sweep
    Results for several values of a parameter.
Film.assign
    The place and orientation of each measured tile.
Film.calibrate
    The stiffness of the elastic layer, from forces and readings.
Film.scan, Film.sample
    Measured scans against the film, and computed scans of films as made.
Film.diagnose
    Faulty tiles of a film as made, from a scan of its field.
Film.design, Film.front
    Better films.
Film.plot, Film.report, Film.view, magsplice.plot
    Figures: SVG and PNG, a page, matplotlib.
getB, getH, from_magpylib, Film.to_magpylib
    Cuboids of magpylib.

Source of the method: Dai et al., "A Magnet Splicing Method for Constructing a Three-Dimensional
Self-Decoupled Magnetic Tactile Sensor", Magnetochemistry 2024, 10(1), 6, here "Dai 2024".
"""

from magsplice import errors, plot
from magsplice._assignment import MeasuredTile, PlacedTile, Shim
from magsplice._budget import Budget, BudgetPart, Improvement
from magsplice._calibration import Calibration, Stiffness
from magsplice._check import Check, Outcome
from magsplice._comparison import Comparison, Decoupling
from magsplice._diagnosis import Diagnosis, FaultyTile
from magsplice._experiment import Experiment
from magsplice._figures import Estimate, Figures, Statistics
from magsplice._film import Assignment, Design, Film, Front
from magsplice._forces import Forces, PlacementOrder
from magsplice._head import Head
from magsplice._layout import Grid, Ideal, Lattice, Tile, Tiles, Volume
from magsplice._load import from_magpylib, load, loads, pattern, splice
from magsplice._magpylib.fields import getB, getH
from magsplice._magsplice import __version__
from magsplice._parts import Part, Parts
from magsplice._recoil import Recoil, RecoilEstimate
from magsplice._report import Figure, Page, Report
from magsplice._results import PerAxis, PerParameter, Result
from magsplice._samples import SampledFilm, Samples, statistics
from magsplice._scan import (
    ExcludedReadings,
    FittedScan,
    Plateau,
    SampledScan,
    Scan,
    ScanUniformity,
    SensorPlacement,
)
from magsplice._search import Metrics
from magsplice._sensor import Readings
from magsplice._sweep import Sweep
from magsplice.errors import (
    LayoutError,
    LayoutFault,
    LayoutWarning,
    MagspliceError,
    MeasurementWarning,
    PointFault,
    PointsError,
)

__all__ = [
    "Assignment",
    "Budget",
    "BudgetPart",
    "Calibration",
    "Check",
    "Comparison",
    "Decoupling",
    "Design",
    "Diagnosis",
    "Estimate",
    "ExcludedReadings",
    "Experiment",
    "FaultyTile",
    "Figure",
    "Figures",
    "Film",
    "FittedScan",
    "Forces",
    "Front",
    "Grid",
    "Head",
    "Ideal",
    "Improvement",
    "Lattice",
    "LayoutError",
    "LayoutFault",
    "LayoutWarning",
    "MagspliceError",
    "MeasuredTile",
    "MeasurementWarning",
    "Metrics",
    "Outcome",
    "Page",
    "Part",
    "Parts",
    "PerAxis",
    "PerParameter",
    "PlacedTile",
    "PlacementOrder",
    "Plateau",
    "PointFault",
    "PointsError",
    "Readings",
    "Recoil",
    "RecoilEstimate",
    "Report",
    "Result",
    "SampledFilm",
    "SampledScan",
    "Samples",
    "Scan",
    "ScanUniformity",
    "SensorPlacement",
    "Shim",
    "Statistics",
    "Stiffness",
    "Sweep",
    "Tile",
    "Tiles",
    "Volume",
    "__version__",
    "errors",
    "from_magpylib",
    "getB",
    "getH",
    "load",
    "loads",
    "pattern",
    "plot",
    "splice",
    "statistics",
]
