"""What REST takes and gives."""

from __future__ import annotations

from typing import Literal

from pydantic import ConfigDict, Field

from palms.server.messages.base import Message, Point
from palms.server.messages.inputs import Sample, Scan

__all__ = [
    "Building",
    "BuildingList",
    "CodeRequest",
    "Health",
    "Level",
    "LinkRequest",
    "Plan",
    "PlanRoom",
    "Problem",
    "RecordingList",
    "RecordingSummary",
    "SessionList",
    "SessionSummary",
    "Simulation",
    "SimulationRequest",
    "Ticket",
    "TicketRequest",
]

Segment = tuple[tuple[float, float], tuple[float, float]]


class Level(Message):
    """A floor of a building, in few words."""

    name: str
    n_segments: int
    n_rooms: int
    bounds_m: Segment


class Building(Message):
    """A building, in few words."""

    id: str
    name: str
    levels: tuple[Level, ...]
    is_sample: bool = False


class BuildingList(Message):
    """All buildings."""

    buildings: tuple[Building, ...]


class PlanRoom(Message):
    """A room: its name and outline."""

    name: str
    polygon_m: tuple[tuple[float, float], ...]


class Plan(Message):
    """One floor whole, in the map frame; `origin` is longitude and latitude of (0, 0)."""

    schema_name: Literal["palms-plan/1"] = Field("palms-plan/1", alias="schema")
    name: str
    level: str | None = None
    segments_m: tuple[Segment, ...]
    classes: tuple[Literal["wall", "door", "opening", "glass"], ...]
    rooms: tuple[PlanRoom, ...] = ()
    outline_m: tuple[tuple[float, float], ...] | None = None
    origin: tuple[float, float] | None = None


class SessionSummary(Message):
    """A live session, in few words; no place is told."""

    session: str
    building: str
    level: str
    method: str
    stage: str
    is_connected: bool
    is_recording: bool
    n_viewers: int
    n_inputs: int
    created_s: float
    seen_s: float


class SessionList(Message):
    """All live sessions."""

    sessions: tuple[SessionSummary, ...]


class RecordingSummary(Message):
    """A recorded session, in few words."""

    recording: str
    building: str
    level: str
    n_inputs: int
    created_s: float
    ended_s: float


class RecordingList(Message):
    """All recorded sessions."""

    recordings: tuple[RecordingSummary, ...]


class SimulationRequest(Message):
    """A walk that somebody drew, or wants chosen, to be walked by a simulated phone."""

    model_config = ConfigDict(strict=False)  # FastAPI gives lists, not tuples

    building: str = Field(max_length=100)
    level: str | None = Field(None, max_length=200)
    path_m: tuple[Point, ...] | None = Field(None, min_length=1, max_length=5000)
    length_m: float = Field(80.0, gt=0, le=500, allow_inf_nan=False)
    seed: int = Field(0, ge=0, le=2**53)


class Simulation(Message):
    """What a simulated phone sends on a drawn walk, and where it truly was."""

    scan: Scan
    samples: tuple[Sample, ...]
    truth_m: tuple[tuple[float, float], ...]
    is_cut: bool


class CodeRequest(Message):
    """What a QR code shall say, such as the address of the phone's page."""

    text: str = Field(min_length=1, max_length=500)


class LinkRequest(Message):
    """For how long a link to a recording shall be good."""

    ttl_s: float = Field(86_400.0, gt=0, le=30 * 86_400, allow_inf_nan=False)


class TicketRequest(Message):
    """What a one-time ticket shall open."""

    role: Literal["walker", "viewer"] = "walker"
    session: str | None = Field(None, max_length=100)
    building: str | None = Field(None, max_length=100)


class Ticket(Message):
    """A one-time ticket for hello."""

    ticket: str
    expires_in_s: float


class Health(Message):
    """Whether the server works."""

    status: Literal["ok"] = "ok"
    version: str


class Problem(Message):
    """Why a request was refused, in one line."""

    error: str
