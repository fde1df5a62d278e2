"""What a session says in words, and what somebody says or asks in return."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StringConstraints

from palms.server.messages.base import Message, Sequence

__all__ = ["Ask", "Preferences", "Question", "Say", "SayKind", "Tell"]

SayKind = Literal[
    "scan", "progress", "oriented", "localized", "place", "unsure", "lost", "found", "hint",
    "answer", "pause", "resume", "settings",
]  # fmt: skip
Question = Literal["where", "details", "repeat", "near", "options"]
Language = Annotated[str, StringConstraints(pattern=r"^[A-Za-z]{2,8}(-[A-Za-z0-9]{1,8}){0,3}$")]


class Tell(Message):
    """Free words on where the phone is, spoken or typed; a hint once they are understood."""

    type: Literal["tell"] = "tell"
    seq: Sequence
    text: str = Field(min_length=1, max_length=200)


class Ask(Message):
    """A question to the session; nothing of it is kept."""

    type: Literal["ask"] = "ask"
    what: Question = "where"


class Preferences(Message):
    """How the session shall speak; nothing of it is kept."""

    type: Literal["preferences"] = "preferences"
    units: Literal["metres", "feet", "steps"] = "metres"
    step_m: float = Field(0.7, ge=0.2, le=1.5, allow_inf_nan=False)
    language: Language = "en"
    directions: Literal["clock", "degrees", "words"] = "clock"
    every_s: float = Field(5.0, ge=5.0, le=600.0, allow_inf_nan=False)
    details: bool = False
    quiet: bool = False


class Say(Message):
    """A sentence for whoever walks, to be read out or spoken as it stands."""

    type: Literal["say"] = "say"
    number: int
    seq: int
    t_s: float | None = None
    kind: SayKind
    text: str
    details: str | None = None
    urgent: bool = False
    language: str = "en"
