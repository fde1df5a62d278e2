"""Results as JSON: ``palms-track/1`` and ``palms-locate/1``, written whole or not at all.

What is not known is null, infinity among the settings the text ``"inf"``; NaN never occurs.
"""

from __future__ import annotations

import functools
import math
import platform
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from importlib.metadata import version
from typing import Any

from palms.advice import Advice
from palms.belief import Estimate
from palms.building import Building
from palms.floorplan import FloorPlan
from palms.geodesy import Origin
from palms.geometry import wrap_angle
from palms.io.files import write_json
from palms.io.values import StrPath
from palms.localizer import Track
from palms.places import Place
from palms.settings import Settings

__all__ = [
    "LOCATE_SCHEMA",
    "TRACK_SCHEMA",
    "locate_document",
    "settings_document",
    "track_document",
    "versions",
    "write_tracks",
]

TRACK_SCHEMA = "palms-track/1"
LOCATE_SCHEMA = "palms-locate/1"
_PACKAGES = ("numpy", "scipy", "numba", "shapely")


def track_document(
    tracks: Iterable[Track],
    plan: FloorPlan,
    settings: Settings,
    advice: Advice | None = None,
    **names: str | None,
) -> dict[str, Any]:
    """Return tracks as a ``palms-track/1`` document.

    Parameters
    ----------
    tracks : iterable of Track
        One for each trial.
    plan : FloorPlan
    settings : Settings
        They name the method.
    advice : Advice, optional
        How much the first scan tells.
    **names
        What else to call the input by: scan, walk, walk_source.

    Examples
    --------
    >>> from palms.belief import Estimate
    >>> plan = FloorPlan([[[0, 0], [8, 0]]], name="hall")
    >>> document = track_document([Track(0, (Estimate(0.5),))], plan, Settings())
    >>> document["trials"][0]["steps"]["x_m"]
    [None]
    """
    return {
        "schema": TRACK_SCHEMA,
        "plan": plan.name,
        "method": settings.method,
        **names,
        **_advised(advice),
        "settings": settings_document(settings),
        "versions": versions(),
        "trials": [_trial(track, plan.origin) for track in tracks],
    }


def write_tracks(
    path: StrPath, tracks: Iterable[Track], plan: FloorPlan, settings: Settings
) -> None:
    """Write tracks as a ``palms-track/1`` file.

    Raises
    ------
    OutputError
        When it cannot be written; what was there before is still there.

    Examples
    --------
    >>> import tempfile
    >>> plan = FloorPlan([[[0, 0], [8, 0]]], name="hall")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_tracks(f"{folder}/track.json", [], plan, Settings())
    """
    write_json(path, track_document(tracks, plan, settings))


def _advised(advice: Advice | None) -> dict[str, Any]:
    if advice is None:
        return {}
    view = advice.view
    gaps = [{"middle_rad": gap.middle_rad, "width_rad": gap.width_rad} for gap in view.gaps]
    return {
        "advice": {
            "n_places": advice.n_places, "mass": _probability(advice.mass),
            "n_walls": view.n_walls, "one_way": view.one_way, "unseen": view.unseen, "gaps": gaps,
        }
    }  # fmt: skip


def locate_document(
    places: Sequence[Place],
    plan: FloorPlan | Building,
    scan: str,
    settings: Settings,
    advice: Advice | None = None,
) -> dict[str, Any]:
    """Return candidate places as a ``palms-locate/1`` document.

    Parameters
    ----------
    places : sequence of Place
        As many as wanted, most probable first, in map metres.
    plan : FloorPlan or Building
        It names level and rooms; places of a building say their level.
    scan : str
        What to call the scan.
    settings : Settings
    advice : Advice, optional
        How much the scan tells.

    Examples
    --------
    >>> plan = FloorPlan([[[0, 0], [8, 0]]], name="hall")
    >>> document = locate_document([Place(1.0, 2.0, 0.1, 0.5, 7.0)], plan, "Session_1", Settings())
    >>> document["candidates"][0]["p"], document["candidates"][0]["room"]
    (0.5, None)
    """
    building = Building((plan,)) if isinstance(plan, FloorPlan) else plan
    lowest = building.levels[0]
    return {
        "schema": LOCATE_SCHEMA,
        "plan": lowest.name,
        "scan": scan,
        "method": settings.method,
        "candidates": [
            _candidate(each, lowest if each.level is None else building.level(each.level))
            for each in places
        ],
        **_advised(advice),
        "settings": settings_document(settings),
        "versions": versions(),
    }


def _candidate(place: Place, plan: FloorPlan) -> dict[str, Any]:
    return {
        "x_m": place.x_m,
        "y_m": place.y_m,
        "drift_rad": _angle(place.drift_rad),
        "p": _probability(place.p),
        "level": plan.level,
        "room": plan.room_at((place.x_m, place.y_m)),
        **_on_earth(place, plan),
    }


def _on_earth(place: Place, plan: FloorPlan) -> dict[str, float]:
    if plan.origin is None:
        return {}
    lon, lat = lonlat(plan.origin, (place.x_m, place.y_m))
    return {"lon": lon, "lat": lat}


def settings_document(settings: Settings) -> dict[str, Any]:
    """Return all settings for JSON, infinity as the text ``"inf"``.

    Examples
    --------
    >>> settings_document(Settings())["template"]["range_sigma_m"]
    'inf'
    """
    plain: dict[str, Any] = _plain(asdict(settings))
    return plain


@functools.cache
def _versions() -> tuple[tuple[str, str], ...]:
    ours = ("palms", version("palms-localization"))
    return (
        ours,
        *((name, version(name)) for name in _PACKAGES),
        ("python", platform.python_version()),
    )


def versions() -> dict[str, str]:
    """Return the versions that a result depends on.

    Examples
    --------
    >>> list(versions())
    ['palms', 'numpy', 'scipy', 'numba', 'shapely', 'python']
    """
    return dict(_versions())


def _plain(value: Any) -> Any:  # noqa: ANN401
    if isinstance(value, dict):
        return {str(key): _plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value if isinstance(value, str | int | float | None) else str(value)


def _trial(track: Track, origin: Origin | None) -> dict[str, Any]:
    return {
        "seed": track.seed,
        "oriented_at_s": _number(track.oriented_at_s),
        "localized_at_s": _number(track.localized_at_s),
        "steps": _steps(track.estimates) | _places_on_earth(track.estimates, origin),
    }


def _places_on_earth(
    estimates: Sequence[Estimate], origin: Origin | None
) -> dict[str, list[float | None]]:
    """Longitudes and latitudes, where the plan knows its place on Earth; else nothing."""
    if origin is None:
        return {}
    points = [_point(estimate) for estimate in estimates]
    found = [(None, None) if x is None else lonlat(origin, (x, y or 0.0)) for x, y in points]
    return {"lon": [lon for lon, _ in found], "lat": [lat for _, lat in found]}


def lonlat(origin: Origin, point_m: tuple[float, float]) -> tuple[float, float]:
    """Longitude and latitude in degrees of a point of the map, to a millimetre.

    Examples
    --------
    >>> lonlat(Origin(30.38, 60.007), (0.0, 0.0))
    (30.38, 60.007)
    """
    lon, lat = (round(float(v), 8) for v in origin.to_lonlat(point_m))
    return lon, lat


def _steps(estimates: Sequence[Estimate]) -> dict[str, list[Any]]:
    """Return lists, an entry for each estimate; without a position nothing else is said."""
    points = [_point(estimate) for estimate in estimates]
    known = [
        estimate if x is not None else Estimate(estimate.time_s, estimate.stage)
        for estimate, (x, _) in zip(estimates, points, strict=True)
    ]
    return {
        "t_s": [float(e.time_s) for e in estimates],
        "x_m": [x for x, _ in points],
        "y_m": [y for _, y in points],
        "heading_rad": [_angle(e.heading_rad) for e in known],
        "drift_rad": [_angle(e.drift_rad) for e in known],
        "stage": [str(e.stage) for e in known],
        "p_within_1m": [_probability(e.p_within_1m) for e in known],
        "p_within_2m": [_probability(e.p_within_2m) for e in known],
        "radius_68_m": [_number(e.radius_68_m) for e in known],
        "radius_95_m": [_number(e.radius_95_m) for e in known],
        **_levels(known),
    }


def _levels(estimates: Sequence[Estimate]) -> dict[str, list[Any]]:
    """Levels and their probabilities, in a building of several; else nothing."""
    if all(estimate.level is None for estimate in estimates):
        return {}
    return {
        "level": [e.level for e in estimates],
        "p_level": [0.0 if e.level is None else _probability(e.p_level) for e in estimates],
    }


def _point(estimate: Estimate) -> tuple[float | None, float | None]:
    if estimate.position_m is None:
        return None, None
    x, y = (_number(float(v)) for v in estimate.position_m)
    return (x, y) if x is not None and y is not None else (None, None)


def _number(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)


def _angle(value: float | None) -> float | None:
    number = _number(value)
    if number is None or -math.pi < number <= math.pi:
        return number
    wrapped = float(wrap_angle(number))
    return wrapped if wrapped > -math.pi else math.pi


def _probability(value: float) -> float:
    return min(max(_number(value) or 0.0, 0.0), 1.0)
