"""Sensors and positions of magpylib."""

from __future__ import annotations

from typing import Any

import numpy as np

from magsplice._layout import Floats
from magsplice._magpylib.cuboids import imported, label_of


class Sensor:
    """Pixels along a path, and the frame of their field."""

    def __init__(self, pixels: Floats, sensor: Any = None) -> None:
        self.shape = pixels.shape[:-1] or (1,)
        self.pixels = pixels.reshape(-1, 3)
        self.label = "positions" if sensor is None else label_of(sensor)
        self.left_handed = sensor is not None and sensor.handedness == "left"
        self.position = np.zeros((1, 3)) if sensor is None else np.atleast_2d(sensor.position)
        self.rotation = None
        if sensor is not None:
            quaternions = np.atleast_2d(sensor.orientation.as_quat())
            if not np.all(quaternions == (0, 0, 0, 1)):
                self.rotation = quaternions
        self.length = max(len(self.position), 1 if self.rotation is None else len(self.rotation))

    def _matrices(self, steps: int) -> Floats | None:
        if self.rotation is None:
            return None
        from scipy.spatial.transform import Rotation

        matrices: Floats = Rotation.from_quat(self.rotation).as_matrix()
        return matrices[np.minimum(np.arange(steps), len(matrices) - 1)]

    def points(self, steps: int) -> Floats:
        """Positions of the pixels, shape (steps, pixels, 3)."""
        position = self.position[np.minimum(np.arange(steps), len(self.position) - 1)]
        matrices = self._matrices(steps)
        if matrices is None:
            return self.pixels + position[:, None]
        turned: Floats = np.matmul(matrices, self.pixels.T).transpose(0, 2, 1)
        return turned + position[:, None]

    def read(self, field: Floats) -> Floats:
        """Field of shape (sources, steps, pixels, 3) in the frame of the sensor."""
        matrices = self._matrices(field.shape[1])
        if matrices is not None:
            field = np.matmul(field, matrices)
        if self.left_handed:
            field = field * (-1.0, 1.0, 1.0)
        return field


def sensors_of(observers: Any) -> list[Sensor]:
    """Sensors, or positions in metres as one sensor."""
    magpylib = imported()

    def of(item: Any) -> list[Sensor]:
        if isinstance(item, magpylib.Sensor):
            pixel = item.pixel
            return [Sensor(np.zeros(3) if pixel is None else np.asarray(pixel, float), item)]
        if isinstance(item, magpylib.Collection):
            if not item.sensors_all:
                raise ValueError(f"{item!r} has no sensors")
            return [sensor for child in item.sensors_all for sensor in of(child)]
        return [Sensor(_positions(item))]

    kinds = (magpylib.Sensor, magpylib.Collection)
    if isinstance(observers, kinds):
        return of(observers)
    if isinstance(observers, (list, tuple)) and any(isinstance(item, kinds) for item in observers):
        return [sensor for item in observers for sensor in of(item)]
    return [Sensor(_positions(observers))]


def _positions(values: Any) -> Floats:
    points = np.asarray(values, dtype=float)
    if points.ndim == 0 or points.shape[-1] != 3 or points.size == 0:
        raise ValueError(
            f"observers have the shape {points.shape}, must have (o1, o2, ..., 3) with positions "
            "in metres, or be sensors"
        )
    return points
