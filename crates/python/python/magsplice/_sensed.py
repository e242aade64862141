"""What sensors read of a film: positions, forces, scans, and faulty tiles."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from magsplice import _findings, _magsplice
from magsplice._arguments import whole
from magsplice._assembly import Assembly
from magsplice._calibration import Calibration
from magsplice._diagnosis import Diagnosis
from magsplice._experiment import Experiment, bend_of
from magsplice._layout import Floats, Grid, three_of, vector
from magsplice._points import flattened, shaped
from magsplice._samples import Preset
from magsplice._scan import (
    SampledScan,
    Scan,
    Unknown,
    check_scan,
    fitted_words,
)
from magsplice._sensor import HeadFit, Readings, constant_or_rest, noise_of


class Sensed(Assembly):
    """Methods about readings of a sensor below the film."""

    def _required_grid(self) -> Grid:
        """Grid of the working volume. MagspliceError without one."""
        raise NotImplementedError

    def read(
        self,
        readings_t: ArrayLike,
        *,
        noise_t: float | Sequence[float] | None = None,
        constant_t: Sequence[float] = (0.0, 0.0, 0.0),
        zero: ArrayLike | None = None,
        rest: ArrayLike | None = None,
        fit: HeadFit | None = None,
    ) -> Readings:
        """Displacements and forces from the readings of a Hall sensor below the film.

        The exact field and its gradient give the positions. Errors of the positions are errors of
        the field (docs/accuracy.md) over its gradient.

        Parameters
        ----------
        readings_t : array_like of shape (..., 3)
            Readings of the sensor of ``[sensor]``, in tesla; without this table the sensor is a
            point that reads B.
        noise_t : float or sequence of 3 floats, optional
            Standard deviation of a reading along each axis, in tesla. Default: the noise of
            ``[sensor]``.
        constant_t : sequence of 3 floats
            Part of every reading in addition to the film's field, in tesla, such as a stray field.
        zero : array_like of shape (..., 3), optional
            Readings of the sensor at rest at the reference point, in tesla. The difference of their
            mean from the field there is subtracted from all readings. Excludes `constant_t`.
        rest : array_like of shape (..., 3), optional
            Readings of the sensor at rest, in tesla, in the field of the film alone. Displacements
            count from their position. Excludes `constant_t` and `zero`.
        fit : {"position", "stray-field", "pose"}, optional
            What is fitted to the readings of all sensors of a head: the position, with a uniform
            stray field, with tilts and turn of the board too. Readings, `zero` and `rest` then have
            the shape (..., N, 3), one reading of each of the N sensors in their order. Default:
            the readings of a head are the weighted sums of its sensors.

        Returns
        -------
        Readings
            Displacements from the reference point, with standard deviations if the noise is known,
            and forces if the layout has an ``[elastomer]``.

        Raises
        ------
        MagspliceError
            If the sensor cannot read the field, or the mean of `rest` has no position, or the
            layout has no head with enough sensors for `fit`.
        ValueError
            If more than one of `constant_t`, `zero` and `rest` is given, one has no readings or
            readings that are not finite, or a noise is not above 0; or readings for `fit` have
            another shape than (..., N, 3).

        Warns
        -----
        MeasurementWarning
            If readings have positions with other axes or another unit alone, or the sensors of a
            head contradict each other.
        """
        flat, shape = flattened(readings_t, "readings")
        constant, zero_t, rest_t = constant_or_rest(constant_t, zero, rest)
        if fit is None:
            _warn_of_range(self, flat[:0], flat)
            of_head = None
        else:
            shape, of_head = shape[:-1], (fit, shape[-1] if shape else 1)
        noise = noise_of(noise_t)
        (numbers, more), remarks = _magsplice.read(
            self, flat, noise, constant, (zero_t, rest_t), of_head
        )
        _findings.warn_of_measurement(self, remarks)
        return Readings(numbers, **shaped(more, shape))

    def calibrate(
        self,
        forces_n: ArrayLike,
        readings_t: ArrayLike,
        *,
        constant_t: Sequence[float] = (0.0, 0.0, 0.0),
        zero: ArrayLike | None = None,
        rest: ArrayLike | None = None,
    ) -> Calibration:
        """Stiffness of the elastic layer from forces and readings, as in ``magsplice calibrate``.

        For each axis, a line force = stiffness x displacement of the film + force at rest is fitted
        (Dai 2024, Eqs. 16 and 17), with intervals of 95 % confidence.

        Parameters
        ----------
        forces_n : array_like of shape (..., 3)
            Forces on the film, in newton. A component may be NaN: it is missing.
        readings_t : array_like of shape (..., 3)
            Readings of the sensor under these forces, in tesla; see `read`.
        constant_t, zero, rest : optional
            A constant part of the readings, or readings of the film at rest; see `read`.

        Raises
        ------
        MagspliceError
            If no axis has a stiffness, or as in `read`.
        ValueError
            If the numbers of forces and readings differ, or as in `read`.

        Warns
        -----
        MeasurementWarning
            If axes are exchanged, or an axis with forces has no stiffness, or a negative one.
        """
        (forces, shape), (readings, _) = (
            flattened(forces_n, "forces"),
            flattened(readings_t, "readings"),
        )
        if len(forces) != len(readings):
            raise ValueError(f"{len(readings)} readings for {len(forces)} forces, must be as many")
        _warn_of_range(self, readings[:0], readings)
        constant = constant_or_rest(constant_t, zero, rest)
        (numbers, more), remarks = _magsplice.calibrate(self, forces, readings, *constant)
        _findings.warn_of_measurement(self, remarks)
        return Calibration(numbers, **shaped({**more, "force_n": forces.copy()}, shape))

    def experiment(
        self,
        step_mm: float | Sequence[float] = (0.5, 0.5, 1.0),
        *,
        seed: int | None = None,
        shift_mm: Sequence[float] = (0.0, 0.0, 0.0),
        rotation_deg: Sequence[float] = (0.0, 0.0, 0.0),
        bend_radius_mm: float | None = None,
        bend_along: Literal["x", "y"] = "x",
        heights_mm: ArrayLike | None = None,
    ) -> Experiment:
        """Readings of the sensor while the film moves, as in ``magsplice experiment``.

        The film moves by multiples of a step along x, then y, then z, as far as the sensor stays in
        the working volume (Dai 2024, Fig. 9). The film that moves may differ from the layout: it
        may be bent, then turned about its centre, then shifted.

        Parameters
        ----------
        step_mm : float or (x, y, z)
            Step along each axis, in millimetres.
        seed : int, optional
            Seed of the noise of ``[sensor]``. Default: readings without noise.
        shift_mm : (x, y, z)
            Shift of the film, in millimetres.
        rotation_deg : (x, y, z)
            Rotation vector of the film, in degrees.
        bend_radius_mm : float, optional
            Bending radius, in millimetres; with a positive radius the ends of the film rise away
            from the sensor. Default: flat.
        bend_along : {"x", "y"}
            Axis along which the film is bent.
        heights_mm : array_like of shape (..., 3), optional
            Heights of the film above its flat shape as points x, y, z on a full grid, in
            millimetres. Excludes `bend_radius_mm`.

        Raises
        ------
        ValueError
            If the film cannot have this shape.
        MagspliceError
            If the layout has no working volume, or no noise for `seed`, a step is not above 0 or
            makes more than 100 000 steps, or the sensor cannot read the field.
        """
        numbers, quantities = _magsplice.experiment(
            self,
            vector("step_mm", np.broadcast_to(np.asarray(step_mm, dtype=float), 3)),
            None if seed is None else whole("seed", seed, 0),
            vector("shift_mm", shift_mm),
            vector("rotation_deg", rotation_deg),
            bend_of(bend_radius_mm, bend_along, heights_mm),
        )
        return Experiment(numbers, quantities)

    def resolution(
        self,
        points: ArrayLike | Grid | None = None,
        *,
        noise_t: float | Sequence[float] | None = None,
    ) -> Floats:
        """Standard deviations of the position from one reading, in millimetres.

        The shape is (..., 3). No unbiased estimate from one reading has smaller deviations (the
        bound of Cramér and Rao).

        Parameters
        ----------
        points : array_like of shape (..., 3), or Grid, optional
            Points in millimetres. Default: the grid of the working volume.
        noise_t : float or sequence of 3 floats, optional
            Standard deviation of a reading along each axis, in tesla. Default: the noise of
            ``[sensor]``.

        Raises
        ------
        ValueError
            If neither `noise_t` nor the layout gives a noise, or a noise is not above 0.
        MagspliceError
            If the sensor cannot read the field.
        """
        flat, shape = flattened(self._required_grid() if points is None else points)
        found = _magsplice.resolution(self, flat, noise_of(noise_t))
        if found is None:
            raise ValueError(
                "noise_t is missing and the layout has no [sensor] with noise: "
                "give noise_t in tesla, such as 5e-6"
            )
        return found.reshape(*shape, 3)

    def scan(
        self,
        points_mm: ArrayLike,
        readings_t: ArrayLike,
        *,
        fit: Collection[Unknown] | Literal["all"] | None = None,
    ) -> Scan:
        """Comparison of a measured scan with the film, as in ``magsplice scan``.

        The unknown parameters of the scan are fitted by least squares, with standard deviations.

        Parameters
        ----------
        points_mm : array_like of shape (..., 3)
            Positions of the scan, in millimetres.
        readings_t : array_like of shape (..., 3)
            Readings of the sensor of ``[sensor]`` there, in tesla; without this table, B. Readings
            with NaN are excluded.
        fit : "all" or collection of {"strength", "offset", "rotation", "start"}, optional
            Parameters to fit: the strength of all tiles, a constant reading, the rotation of the
            sensor, its position at the origin of the scan. Default: all; where errors of tiles look
            like another strength and height, all but the strength.

        Raises
        ------
        ValueError
            If the numbers of readings and points differ, a position is not finite, or `fit` has
            another word.
        MagspliceError
            If the scan does not determine the parameters, or is of another film.

        Warns
        -----
        MeasurementWarning
            If axes are exchanged or reversed, or the scan is hardly of this film.

        Examples
        --------
        >>> made = film.sample(7, preset="workshop")  # doctest: +SKIP
        >>> film.scan(made.points_mm, made.readings_t).fitted.strength  # doctest: +SKIP
        """
        (points, shape), (readings, _) = flattened(points_mm), flattened(readings_t, "readings")
        check_scan(points, readings)
        words = None if fit is None else fitted_words(fit)
        _warn_of_range(self, points, readings)
        (numbers, more), quantities, remarks = _magsplice.scan(self, points, readings, words)
        _findings.warn_of_measurement(self, remarks)
        return Scan(numbers, more, quantities, shape)

    def sample(
        self,
        index: int = 0,
        points_mm: ArrayLike | Grid | None = None,
        *,
        preset: Preset | None = None,
        seed: int | None = None,
    ) -> SampledScan:
        """One film as made and a scan of its field, as in ``magsplice tolerance sample``.

        The readings have the errors of this sample of ``[tolerance]``, and noise, counts and range
        of ``[sensor]``.

        Parameters
        ----------
        index : int
            Number of the sample, as in `tolerance`.
        points_mm : array_like of shape (..., 3), or Grid, optional
            Positions of the scan, in millimetres. Default: the grid of the working volume.
        preset : {"by-hand", "workshop", "jig"}, optional
            Typical errors of every tile, instead of the errors of the layout.
        seed : int, optional
            Seed. Default: the seed in the layout, else 1.

        Raises
        ------
        ValueError
            If neither `preset` nor the layout gives errors, or a position is not finite.
        MagspliceError
            If a tile of the sample cannot exist, or the sensor cannot read the field.
        """
        index = whole("index", index, 0)
        seed = self._sampling[1] if seed is None else whole("seed", seed, 0)
        flat, shape = flattened(self._required_grid() if points_mm is None else points_mm)
        check_scan(flat, flat)
        (numbers, more), text = _magsplice.sample(self, preset, seed, index, flat)
        return SampledScan(numbers, film=self._of_text(text), **shaped(more, shape))

    def diagnose(
        self,
        points_mm: ArrayLike,
        readings_t: ArrayLike,
        *,
        noise_t: float | Sequence[float] | None = None,
        preset: Preset | None = None,
        as_ordered: bool = False,
        fit: Collection[Unknown] | Literal["all"] = (),
        false_alarm: float = 0.002,
    ) -> Diagnosis:
        """Weak, turned or displaced tiles, from a scan of the field near the film.

        An error is reported if neither the noise nor the expected errors of tiles explain it, as in
        ``magsplice diagnose``. Recoil adds the same field as in the film as ordered.

        Parameters
        ----------
        points_mm : array_like of shape (..., 3)
            Positions of the scan in the frame of the film, in millimetres.
        readings_t : array_like of shape (..., 3)
            Readings of the sensor of ``[sensor]`` there, in tesla; without this table, B.
        noise_t : float or sequence of 3 floats, optional
            Standard deviation of a reading along each axis, in tesla. Default: the noise of
            ``[sensor]``.
        preset : {"by-hand", "workshop", "jig"}, optional
            Expected errors of every tile, instead of ``[tolerance]``.
        as_ordered : bool
            Whether to ignore ``[tolerance]``: other tiles count as exactly as ordered.
        fit : "all" or collection of {"strength", "offset", "rotation", "start"}
            Unknown parameters of the scan, to be fitted: the strength of all tiles, a constant
            reading, the rotation of the sensor, its position at the origin of the scan. Default:
            none, for a scan at the stated positions.
        false_alarm : float
            Probability that a tile of a fault-free film is reported.

        Raises
        ------
        ValueError
            If the numbers of readings and points differ, `fit` has another word, or `preset` and
            `as_ordered` are both given.
        MagspliceError
            If the noise is unknown, or the scan cannot be diagnosed.

        Warns
        -----
        MeasurementWarning
            If errors of every tile explain the scan as well as many errors of single tiles, or
            errors of tiles do not explain it.
        """
        points, readings = flattened(points_mm)[0], flattened(readings_t, "readings")[0]
        check_scan(points, readings)
        words = fitted_words(fit)
        if preset is not None and as_ordered:
            raise ValueError("preset and as_ordered are both given: give one of them")
        _warn_of_range(self, points, readings)
        (numbers, errors), remarks = _magsplice.diagnose(
            self, points, readings, three_of(noise_t), preset, as_ordered, words, false_alarm
        )
        _findings.warn_of_measurement(self, remarks)
        return Diagnosis(numbers, names=self.tiles.names, errors=errors)


def _warn_of_range(film: Sensed, points: Floats, readings: Floats) -> None:
    """Warns of readings at the limit of the sensor's range, before what follows from them."""
    remark = _magsplice.remark_on_range(film, points, readings)
    _findings.warn_of_measurement(film, [] if remark is None else [remark])
