"""A camera that looks at a scene from afar: turned, zoomed, projected in parallel."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from armodal.protocols.arrays import frozen_array

__all__ = ["Camera"]

Array = npt.NDArray[np.float64]

_STEEPEST_RAD = np.pi / 2
_FROM_SIDE_RAD = np.deg2rad(65.0)
_AROUND_RAD = np.deg2rad(np.arange(0.0, 360.0, 5.0))
_ZOOM = (0.1, 50.0)
_MARGIN = 0.92  # of the smaller side, so that nothing touches the frame


@dataclass(frozen=True, slots=True, kw_only=True)
class Camera:
    """Where from and how near a scene is seen; z of the scene is up on the screen.

    Azimuth 0 looks along -x (x towards the eye, y to the right); elevation is above the horizon.
    """

    center_m: Array  # (3,) shown in the middle
    radius_m: float  # of the upright cylinder that holds the scene
    half_height_m: float  # of the same
    azimuth_rad: float = np.deg2rad(-50.0)
    elevation_rad: float = np.deg2rad(20.0)
    zoom: float = 1.0

    @classmethod
    def around(cls, points_m: npt.ArrayLike) -> Camera:
        """Camera whose picture holds all of `points_m` (n, 3) from every side."""
        points = np.asarray(points_m, dtype=np.float64).reshape(-1, 3)
        if not len(points):
            origin = frozen_array(np.zeros(3), np.float64)
            return cls(center_m=origin, radius_m=1.0, half_height_m=1.0)
        center = (points.min(axis=0) + points.max(axis=0)) / 2
        flat = (points - center)[:, :2]
        # Seen from the side of the longest horizontal direction, a little from ahead.
        along = np.linalg.svd(flat, full_matrices=False)[2][0]
        if along @ flat.sum(axis=0) < 0.0:
            along = -along
        return cls(
            center_m=frozen_array(center, np.float64),
            radius_m=max(float(np.linalg.norm(flat, axis=1).max()), 1e-6),
            half_height_m=max(float(np.ptp(points[:, 2])) / 2, 1e-6),
            azimuth_rad=float(np.arctan2(along[1], along[0]) - _FROM_SIDE_RAD),
        )

    def facing(self, motion_m: npt.ArrayLike) -> Camera:
        """Return the camera moved around to where `motion_m` (n, 3) is seen largest."""
        motion = np.asarray(motion_m, dtype=np.float64).reshape(-1, 3)
        views = [self.turned(azimuth_rad) for azimuth_rad in _AROUND_RAD]
        seen = [float(np.sum((motion @ view.directions()[:2].T) ** 2)) for view in views]
        return views[int(np.argmax(seen))]

    def turned(self, azimuth_rad: float = 0.0, elevation_rad: float = 0.0) -> Camera:
        """Return the camera moved around the scene; it never goes past straight above or below."""
        return replace(
            self,
            azimuth_rad=float((self.azimuth_rad + azimuth_rad + np.pi) % (2 * np.pi) - np.pi),
            elevation_rad=float(
                np.clip(self.elevation_rad + elevation_rad, -_STEEPEST_RAD, _STEEPEST_RAD)
            ),
        )

    def zoomed(self, factor: float) -> Camera:
        """Return the camera `factor` times as near."""
        return replace(self, zoom=float(np.clip(self.zoom * factor, *_ZOOM)))

    def directions(self) -> Array:
        """Rows: right, up, towards the eye, in the scene's frame: (3, 3)."""
        a, e = self.azimuth_rad, self.elevation_rad
        toward = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        return np.stack([right, np.cross(toward, right), toward])

    def pixels_a_metre(self, width: int, height: int) -> float:
        """Scale of the picture on a canvas of that many pixels."""
        rise = abs(np.sin(self.elevation_rad)) * self.radius_m
        high = rise + np.cos(self.elevation_rad) * self.half_height_m
        return float(_MARGIN * self.zoom * min(width / self.radius_m, height / high) / 2.0)

    def project(self, points_m: npt.ArrayLike, width: int, height: int) -> Array:
        """Pixels (..., 2) of points (..., 3) on a canvas of width x height pixels."""
        points = np.asarray(points_m, dtype=np.float64)
        seen = (points - self.center_m) @ self.directions()[:2].T
        scale = self.pixels_a_metre(width, height)
        return np.stack(
            [
                (width - 1) / 2 + scale * seen[..., 0],
                (height - 1) / 2 - scale * seen[..., 1],
            ],
            axis=-1,
        )
