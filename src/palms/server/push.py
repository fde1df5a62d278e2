"""Readings as the app Sensor Logger pushes them over HTTP: its JSON into ours.

``{"messageId": 7, "payload": [{"name": "accelerometer", "time": ns, "values": {"x": ...}}, ...]}``.
Names of sensors may have capitals and spaces; those that are not needed are left out.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple, cast, get_args

from palms.errors import FormatError
from palms.server.messages.inputs import Reading, Sensor

__all__ = ["Push", "readings_of"]

MAX_READINGS = 20_000
_NS = 1e-9
_COUNT_BITS = 53


class Push(NamedTuple):
    """What a push holds: its number, as the app counts, and its readings in order."""

    number: int | None
    readings: tuple[Reading, ...]


def readings_of(body: dict[str, Any]) -> Push:
    """Return the readings of a push; what cannot be read is left out.

    Raises
    ------
    FormatError
        When there is no payload.

    Examples
    --------
    >>> push = readings_of({"messageId": 4, "payload": [
    ...     {"name": "Gyroscope", "time": 1.5e18, "values": {"x": 0, "y": 0.1, "z": 0}},
    ...     {"name": "Light", "time": 1.5e18, "values": {"lux": 3}},
    ... ]})
    >>> push.number, [reading.sensor for reading in push.readings]
    (4, ['gyroscope'])
    """
    payload = body.get("payload")
    if not isinstance(payload, list):
        raise FormatError("push", expected="payload, a list of readings", got="none")
    found = [reading for item in payload[:MAX_READINGS] if (reading := _reading(item)) is not None]
    number = body.get("messageId")
    if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number < 2**_COUNT_BITS:
        number = None
    return Push(number, tuple(found))


def _reading(item: object) -> Reading | None:
    if not isinstance(item, dict) or not isinstance(item.get("values"), dict):
        return None
    name = str(item.get("name", "")).lower().replace(" ", "")
    if name not in get_args(Sensor):
        return None
    keys = ("qx", "qy", "qz", "qw") if name == "orientation" else ("x", "y", "z")
    time = _number(item.get("time"))
    values = [_number(item["values"].get(key)) for key in keys]
    if time is None or any(value is None or abs(value) > 1e4 for value in values):
        return None
    t_s = time * _NS
    if abs(t_s) > 1e11:
        return None
    return Reading(sensor=cast(Sensor, name), t_s=t_s, values=tuple(v or 0.0 for v in values))


def _number(value: object) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        number = float(value)
    except (ValueError, OverflowError):
        return None
    return number if math.isfinite(number) else None
