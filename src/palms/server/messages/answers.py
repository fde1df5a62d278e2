"""What the server sends over the socket."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, TypeAdapter, ValidationError

from palms.server.messages.base import Message, one_line
from palms.server.messages.inputs import SCHEMA
from palms.server.messages.rest import Building
from palms.server.messages.speech import Say

__all__ = [
    "Ack",
    "Ended",
    "Error",
    "Estimate",
    "Event",
    "EventKind",
    "Link",
    "Path",
    "Place",
    "ServerMessage",
    "Viewer",
    "Viewers",
    "Welcome",
    "parse_answer",
]

EventKind = Literal[
    "scanning", "oriented", "localized", "unsure", "lost", "relocalized", "paused", "resumed",
    "restarted",
]  # fmt: skip
StageWord = Literal["searching", "oriented", "localized", "lost"]


class Welcome(Message):
    """The answer to hello."""

    type: Literal["welcome"] = "welcome"
    protocol: str = SCHEMA
    version: str
    role: Literal["walker", "viewer"]
    session: str
    key: str | None = None
    viewer: int | None = None
    building: Building
    level: str | None = None
    method: str
    seed: int
    next_seq: int
    resumed: bool
    recording: bool
    stage: StageWord
    t_s: float | None = None


class Ack(Message):
    """An input is on disk, or why it is not taken."""

    type: Literal["ack"] = "ack"
    seq: int
    status: Literal["stored", "repeated", "waiting"]
    next_seq: int


class Place(Message):
    """A place where the phone may be."""

    x_m: float
    y_m: float
    p: float
    drift_rad: float
    level: str | None = None
    room: str | None = None


class Estimate(Message):
    """Where the phone is, and how sure that is; fields as in a track."""

    type: Literal["estimate"] = "estimate"
    seq: int
    t_s: float
    stage: StageWord
    x_m: float | None = None
    y_m: float | None = None
    heading_rad: float | None = None
    drift_rad: float | None = None
    drift_spread_rad: float | None = None
    facing_rad: float | None = None
    p_within_1m: float = 0.0
    p_within_2m: float = 0.0
    radius_68_m: float | None = None
    radius_95_m: float | None = None
    level: str | None = None
    p_level: float = 1.0
    room: str | None = None
    lon: float | None = None
    lat: float | None = None
    walked_m: float = 0.0
    n_late: int = 0
    hypotheses: tuple[Place, ...] = ()


class Event(Message):
    """Something happened; numbered, so that nobody misses one."""

    type: Literal["event"] = "event"
    number: int
    kind: EventKind
    seq: int
    t_s: float | None = None


class Path(Message):
    """Where the answers led so far, for who comes later; one entry for each step."""

    type: Literal["path"] = "path"
    t_s: tuple[float, ...]
    x_m: tuple[float | None, ...]
    y_m: tuple[float | None, ...]
    stage: tuple[StageWord, ...]
    level: tuple[str | None, ...] = ()


class Viewer(Message):
    """Somebody who looks on."""

    viewer: int
    name: str
    since_s: float


class Viewers(Message):
    """Who looks on now; sent to the walker whenever that changes."""

    type: Literal["viewers"] = "viewers"
    viewers: tuple[Viewer, ...]


class Link(Message):
    """A key that lets others look on."""

    type: Literal["link"] = "link"
    view: str
    expires_in_s: float


class Ended(Message):
    """The session is over; nothing more comes."""

    type: Literal["ended"] = "ended"
    reason: Literal["ended", "dismissed", "replaced", "idle", "deleted"]
    recording: str | None = None


class Error(Message):
    """What was wrong with a message, in one line; `fatal` closes the socket."""

    type: Literal["error"] = "error"
    code: Literal[
        "message", "protocol", "forbidden", "unknown", "full", "gap", "input", "rate", "size",
        "slow", "stopping", "defect",
    ]  # fmt: skip
    text: str
    fatal: bool = False
    seq: int | None = None
    next_seq: int | None = None


ServerMessage = Welcome | Ack | Estimate | Event | Say | Path | Viewers | Link | Ended | Error
_ANSWER: TypeAdapter[ServerMessage] = TypeAdapter(
    Annotated[ServerMessage, Field(discriminator="type")]
)


def parse_answer(text: str | bytes) -> ServerMessage:
    """Return what a server sent as text.

    Examples
    --------
    >>> parse_answer('{"type": "ack", "seq": 1, "status": "stored", "next_seq": 2}').status
    'stored'
    """
    try:
        return _ANSWER.validate_json(text)
    except ValidationError as error:
        raise one_line(error, "answer") from None
