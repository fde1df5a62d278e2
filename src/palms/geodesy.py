"""Origin: where on Earth a plan's (0, 0) lies; metres to longitude and latitude and back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.geometry import FloatArray

__all__ = ["Origin"]

_A_M = 6_378_137.0  # WGS84: semi-major axis
_E2 = 6.694_379_990_141_3e-3  # WGS84: first eccentricity squared
_STEPS = 4  # of Newton's method; 2 give micrometres over 5 km


@dataclass(frozen=True, slots=True)
class Origin:
    """The place of a plan's (0, 0) on the WGS84 ellipsoid; x is east there and y north.

    Local metres are those of the plane that touches the ellipsoid at the origin, exact to a
    millimetre in length over 2 km.

    Parameters
    ----------
    lon_deg, lat_deg : float
        Longitude and latitude in degrees, as maps and GeoJSON have them.

    Raises
    ------
    InputError
        When they are no place on Earth.

    Examples
    --------
    >>> origin = Origin(30.38, 60.007)
    >>> (origin.to_local([[30.38, 60.008]]).round(3) + 0.0).tolist()
    [[0.0, 111.412]]
    """

    lon_deg: float
    lat_deg: float

    def __post_init__(self) -> None:
        place = np.array([self.lon_deg, self.lat_deg], dtype=np.float64)
        if not (np.isfinite(place).all() and abs(place[0]) <= 360 and abs(place[1]) <= 89.9):
            raise InputError(
                "origin", expected="longitude and latitude in degrees", got=f"{place.tolist()}"
            )

    def to_local(self, lonlat_deg: npt.ArrayLike) -> FloatArray:
        """Local metres (..., 2) of places (..., 2) given as longitude, latitude in degrees."""
        place = np.asarray(lonlat_deg, dtype=np.float64)
        at = _earth_centred(place) - _earth_centred(np.array([self.lon_deg, self.lat_deg]))
        lon, lat = np.radians(self.lon_deg), np.radians(self.lat_deg)
        east = np.array([-np.sin(lon), np.cos(lon), 0.0])
        north = np.array([-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)])
        return np.stack([at @ east, at @ north], axis=-1)

    def to_lonlat(self, points_m: npt.ArrayLike) -> FloatArray:
        """Longitude and latitude (..., 2) in degrees of local points (..., 2) in metres."""
        points = np.asarray(points_m, dtype=np.float64)
        lat = np.radians(self.lat_deg)
        root = np.sqrt(1 - _E2 * np.sin(lat) ** 2)
        metres = np.radians(
            np.array([_A_M / root * np.cos(lat), _A_M * (1 - _E2) / root**3])
        )  # per degree of longitude and of latitude
        place = np.array([self.lon_deg, self.lat_deg]) + points / metres
        for _ in range(_STEPS):
            place = place + (points - self.to_local(place)) / metres
        return np.asarray(place)


def _earth_centred(lonlat_deg: FloatArray) -> FloatArray:
    """Cartesian metres (..., 3) from the centre of the Earth."""
    lon, lat = np.moveaxis(np.radians(lonlat_deg), -1, 0)
    normal = _A_M / np.sqrt(1 - _E2 * np.sin(lat) ** 2)
    flat = normal * np.cos(lat)
    return np.stack(
        [flat * np.cos(lon), flat * np.sin(lon), normal * (1 - _E2) * np.sin(lat)], axis=-1
    )
