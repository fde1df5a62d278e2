"""What happens during a walk, beside it: ``events.json``.

A list of objects with ``t_s`` and ``kind``: ``scan`` (a further scan, in the folder that
``session`` names), ``jump`` (of the odometry, without notice: for the judge alone),
``level`` (the phone notices that it is on another floor) and ``hint`` (somebody says a
``room``, or a ``position_m`` with ``radius_m``, rightly or not; ``probability`` says how
often such are true).
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

from palms.errors import FormatError, InputError, PalmsWarning
from palms.io.files import read_json, write_json
from palms.io.values import StrPath, brief, check_array, check_number

__all__ = ["EVENTS_FILE", "Event", "EventKind", "read_events", "write_events"]

EVENTS_FILE = "events.json"
EventKind = Literal["scan", "jump", "level", "hint"]
_EXPECTED = "a list of events with t_s and kind"


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happens during a walk.

    Parameters
    ----------
    time_s : float
        When, on the walk's clock.
    kind : {"scan", "jump", "level", "hint"}
    session : str, optional
        scan: the folder of the scan.
    shift_m : tuple of float, optional
        jump: what was added to the odometry, odom frame.
    turn_rad : float, optional
        jump: by which all that followed was turned.
    level : str, optional
        level: the floor that was reached. hint: the floor that is meant.
    room : str, optional
        hint: the room that is named.
    position_m : tuple of float, optional
        hint: the middle of the place that is meant, map frame.
    radius_m : float, optional
        hint: and how far around it.
    is_right : bool, optional
        hint: whether it is true; for the judge alone.
    probability : float, optional
        level, hint: how often such are true, as far as the method knows.

    Raises
    ------
    InputError
        When the kind is none of these, or the time is no number.

    Examples
    --------
    >>> Event(12.5, "hint", room="Room 215").room
    'Room 215'
    """

    time_s: float
    kind: EventKind
    session: str | None = None
    shift_m: tuple[float, float] | None = None
    turn_rad: float | None = None
    level: str | None = None
    room: str | None = None
    position_m: tuple[float, float] | None = None
    radius_m: float | None = None
    is_right: bool | None = None
    probability: float | None = None

    def __post_init__(self) -> None:
        if self.kind not in get_args(EventKind):
            raise InputError(
                "event", expected=f"one of {', '.join(get_args(EventKind))}", got=repr(self.kind)
            )
        if not math.isfinite(self.time_s):
            raise InputError("event", expected="a time in seconds", got=str(self.time_s))


def read_events(path: StrPath) -> tuple[Event, ...]:
    r"""Read ``events.json``, in order of time; unknown keys are ignored.

    Raises
    ------
    InputError
        When it cannot be read; the message names the event.

    Warns
    -----
    PalmsWarning
        For each kind that is not known; its events are left out.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_json(f"{folder}/events.json", [{"t_s": 3, "kind": "level", "level": "2"}])
    ...     read_events(f"{folder}/events.json")[0].level
    '2'
    """
    listed = read_json(path, _EXPECTED)
    if not isinstance(listed, list):
        raise FormatError(str(path), expected=_EXPECTED, got=brief(listed))
    events, unknown = [], []
    for index, item in enumerate(listed):
        what = f"{path}: event {index}"
        if not isinstance(item, dict) or "t_s" not in item or "kind" not in item:
            raise FormatError(what, expected="an object with t_s and kind", got=brief(item))
        if item["kind"] in get_args(EventKind):
            events.append(_event(item, what))
        else:
            unknown.append(str(item["kind"]))
    for kind in dict.fromkeys(unknown):
        warnings.warn(
            f"{path}: events of the kind {kind!r} are not known and left out",
            PalmsWarning,
            stacklevel=2,
        )
    return tuple(sorted(events, key=lambda event: event.time_s))


def _event(item: dict[str, Any], what: str) -> Event:
    found: dict[str, Any] = {}
    for key in ("session", "level", "room"):
        if item.get(key) is not None:
            found[key] = str(item[key])
    for key in ("turn_rad", "radius_m", "probability"):
        if item.get(key) is not None:
            found[key] = check_number(item[key], f"{what}, {key}")
    for key in ("shift_m", "position_m"):
        if item.get(key) is not None:
            x, y = check_array(item[key], f"{what}, {key}", (2,)).tolist()
            found[key] = (x, y)
    if item.get("right") is not None:
        found["is_right"] = bool(item["right"])
    return Event(check_number(item["t_s"], f"{what}, t_s"), item["kind"], **found)


def write_events(events: Sequence[Event], path: StrPath) -> None:
    """Write ``events.json``, in order of time.

    Raises
    ------
    OutputError
        When it cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_events([Event(3.0, "hint", room="Hall")], f"{folder}/events.json")
    ...     read_events(f"{folder}/events.json")[0].room
    'Hall'
    """
    ordered = sorted(events, key=lambda event: event.time_s)
    write_json(path, [_content(event) for event in ordered])


def _content(event: Event) -> dict[str, Any]:
    names = ("session", "level", "room", "turn_rad", "radius_m", "probability")
    values: dict[str, Any] = {name: getattr(event, name) for name in names}
    for name in ("shift_m", "position_m"):
        pair = getattr(event, name)
        values[name] = None if pair is None else [float(v) for v in pair]
    values["right"] = event.is_right
    told = {name: value for name, value in values.items() if value is not None}
    return {"t_s": float(event.time_s), "kind": event.kind, **told}
