"""What clients send: hello first, then inputs with sequence numbers, then end."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, TypeAdapter, ValidationError, model_validator

from palms.server.messages.base import (
    Message,
    Metres,
    Name,
    Number,
    Point,
    Radians,
    Seconds,
    Sequence,
    one_line,
)
from palms.server.messages.speech import Ask, Preferences, Tell

__all__ = [
    "SCHEMA",
    "ClientMessage",
    "Dismiss",
    "End",
    "Hello",
    "Hint",
    "Inertial",
    "Input",
    "LevelChange",
    "Odometry",
    "Pause",
    "Pose",
    "Reading",
    "Resume",
    "Sample",
    "Scan",
    "Share",
    "cost",
    "parse_input",
    "parse_message",
]

SCHEMA = "palms-live/1"
Secret = Annotated[str, Field(max_length=100)]
Channel = Literal["estimates", "events", "particles", "heatmaps", "speech"]
Sensor = Literal["accelerometer", "gravity", "totalacceleration", "gyroscope", "orientation"]
SAMPLES_IN_ONE, READINGS_IN_ONE, SCAN_COST = 10, 500, 10.0  # ours: by what they take to follow
WIDTHS = {"orientation": 4}  # numbers in a reading; 3 elsewhere


class Hello(Message):
    """The first message: who speaks, about which building or session, what it wants to hear."""

    type: Literal["hello"] = "hello"
    protocol: str = Field(SCHEMA, max_length=40)
    role: Literal["walker", "viewer"] = "walker"
    ticket: Secret | None = None
    building: Name | None = None
    level: Name | None = None
    one_level: bool = False
    session: Secret | None = None
    key: Secret | None = None
    view: Secret | None = None
    receive: tuple[Channel, ...] = Field(("estimates", "events"), max_length=8)
    max_particles: int = Field(2000, ge=1, le=1_000_000)
    method: Name = "palms"
    particles: int | None = Field(None, ge=1, le=5_000_000)
    seed: int | None = Field(None, ge=0, le=2**53)
    source: Literal["vio", "inertial"] = "vio"
    frame: Literal["scan", "own"] = "scan"
    record: bool = False
    name: str = Field("", max_length=60)


class Pose(Message):
    """Where a device of an AR session is: y up, looking along its -z axis.

    Position and orientation, or a 4 x 4 matrix by columns.
    """

    position: tuple[Metres, Metres, Metres] | None = None
    orientation: tuple[Number, Number, Number, Number] | None = None
    matrix: tuple[Number, ...] | None = Field(None, min_length=16, max_length=16)

    @model_validator(mode="after")
    def _one_way(self) -> Pose:
        if (self.position is None) == (self.matrix is None):
            raise ValueError("a pose has either a position or a matrix")
        return self


class Sample(Message):
    """One sample of odometry: a position, a pose, or how far since the sample before."""

    t_s: Seconds
    position_m: Point | None = None
    displacement_m: Point | None = None
    pose: Pose | None = None
    facing_rad: Radians | None = None

    @model_validator(mode="after")
    def _one_of_three(self) -> Sample:
        given = [self.position_m, self.displacement_m, self.pose]
        if sum(each is not None for each in given) != 1:
            raise ValueError("a sample has one of position_m, displacement_m, pose")
        return self


class Odometry(Message):
    """How the phone moved: samples in order of time."""

    type: Literal["odometry"] = "odometry"
    seq: Sequence
    samples: tuple[Sample, ...] = Field(min_length=1, max_length=500)


class Scan(Message):
    """The walls seen from one point; the first starts the search, others help at any time."""

    type: Literal["scan"] = "scan"
    seq: Sequence
    t_s: Seconds
    form: Literal["walls", "webxr", "arkit"] = "walls"
    planes: tuple[Any, ...] = Field(max_length=2000)
    position_m: Point | None = None
    pose: Pose | None = None
    coverage_m: tuple[Metres | None, ...] | None = Field(None, max_length=3600)


class Hint(Message):
    """Somebody says where the phone is: a room, near a place of the map, or a level."""

    type: Literal["hint"] = "hint"
    seq: Sequence
    room: Name | None = None
    place_m: Point | None = None
    level: Name | None = None
    radius_m: float = Field(5.0, gt=0, le=10_000, allow_inf_nan=False)
    probability: float = Field(0.9, gt=0, lt=1, allow_inf_nan=False)

    @model_validator(mode="after")
    def _says_something(self) -> Hint:
        given = (self.room is not None) + (self.place_m is not None)
        if given == 2 or (given == 0 and self.level is None):
            raise ValueError("a hint has either a room or a place_m, or a level")
        return self


class LevelChange(Message):
    """The phone notices that it is on another level: by its barometer, or its floor."""

    type: Literal["level"] = "level"
    seq: Sequence
    t_s: Seconds | None = None
    level: Name | None = None
    change: int | None = Field(None, ge=-200, le=200)
    probability: float = Field(0.99, gt=0, lt=1, allow_inf_nan=False)

    @model_validator(mode="after")
    def _one_of_two(self) -> LevelChange:
        if (self.level is None) == (self.change is None):
            raise ValueError("it has either the level or the change")
        return self


class Reading(Message):
    """One reading of an inertial sensor, in the phone's axes as Sensor Logger has them."""

    sensor: Sensor
    t_s: Seconds
    values: tuple[Number, ...] = Field(min_length=3, max_length=4)

    @model_validator(mode="after")
    def _complete(self) -> Reading:
        if len(self.values) != WIDTHS.get(self.sensor, 3):
            raise ValueError(f"{self.sensor} has {WIDTHS.get(self.sensor, 3)} values")
        return self


class Inertial(Message):
    """Raw inertial readings; the server finds the steps."""

    type: Literal["inertial"] = "inertial"
    seq: Sequence
    platform: Literal["auto", "android", "ios"] = "auto"
    readings: tuple[Reading, ...] = Field(max_length=20_000)


def cost(message: Message) -> float:
    """Return how many messages a message counts for, where their rate is limited.

    Examples
    --------
    >>> cost(Pause(seq=1)), cost(Scan(seq=1, t_s=0.0, planes=()))
    (1.0, 10.0)
    """
    if isinstance(message, Odometry):
        return max(1.0, len(message.samples) / SAMPLES_IN_ONE)
    if isinstance(message, Inertial):
        return max(1.0, len(message.readings) / READINGS_IN_ONE)
    return SCAN_COST if isinstance(message, Scan) else 1.0


class Pause(Message):
    """The phone stops sending for a while; what comes before resume is left out."""

    type: Literal["pause"] = "pause"
    seq: Sequence


class Resume(Message):
    """The phone goes on; in a new frame its place is kept and its drift found anew."""

    type: Literal["resume"] = "resume"
    seq: Sequence
    same_frame: bool = True
    away_s: float | None = Field(None, ge=0, le=1e6, allow_inf_nan=False)


class Share(Message):
    """Asks for a key that lets others look on, until it expires."""

    type: Literal["share"] = "share"
    ttl_s: float = Field(3600.0, gt=0, le=7 * 86_400, allow_inf_nan=False)


class Dismiss(Message):
    """Sends a viewer away, or all of them; all keys for looking on end, too."""

    type: Literal["dismiss"] = "dismiss"
    viewer: int | None = None


class End(Message):
    """The session is over; its journal goes."""

    type: Literal["end"] = "end"
    keep_recording: bool = True


Input = Odometry | Scan | Hint | LevelChange | Tell | Inertial | Pause | Resume
ClientMessage = Hello | Input | Ask | Preferences | Share | Dismiss | End

_MESSAGE: TypeAdapter[ClientMessage] = TypeAdapter(
    Annotated[ClientMessage, Field(discriminator="type")]
)
_INPUT: TypeAdapter[Input] = TypeAdapter(Annotated[Input, Field(discriminator="type")])


def parse_message(text: str | bytes) -> ClientMessage:
    """Return what a client sent.

    Raises
    ------
    InputError
        When it is no JSON, or no message of this version.

    Examples
    --------
    >>> parse_message('{"type": "pause", "seq": 0}')
    Traceback (most recent call last):
    palms.errors.InputError: message, pause.seq: Input should be greater than or equal to 1
    """
    try:
        return _MESSAGE.validate_json(text)
    except ValidationError as error:
        raise one_line(error, "message") from None


def parse_input(text: str | bytes) -> Input:
    """Return an input as the journal has it.

    Examples
    --------
    >>> parse_input('{"type": "pause", "seq": 4}').seq
    4
    """
    try:
        return _INPUT.validate_json(text)
    except ValidationError as error:
        raise one_line(error, "input") from None
