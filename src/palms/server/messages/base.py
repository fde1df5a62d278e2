"""What all messages share: numbers with bounds, strict types, frozen values."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from palms.errors import InputError

__all__ = [
    "Message",
    "Metres",
    "Name",
    "Number",
    "Point",
    "Radians",
    "Seconds",
    "Sequence",
    "one_line",
]

Number = Annotated[float, Field(allow_inf_nan=False, ge=-1e9, le=1e9)]
Metres = Annotated[float, Field(allow_inf_nan=False, ge=-1e5, le=1e5)]
Radians = Annotated[float, Field(allow_inf_nan=False, ge=-1e3, le=1e3)]
Seconds = Annotated[float, Field(allow_inf_nan=False, ge=-1e11, le=1e11)]
Point = tuple[Metres, Metres]
Name = Annotated[str, Field(max_length=200)]
Sequence = Annotated[int, Field(ge=1, le=2**53)]


class Message(BaseModel):
    """A frozen message; keys that it does not know are ignored, types are not bent."""

    model_config = ConfigDict(extra="ignore", frozen=True, strict=True)


def one_line(error: ValidationError, what: str) -> InputError:
    """Say in one line what is wrong with a message.

    Examples
    --------
    >>> from pydantic import TypeAdapter
    >>> try:
    ...     TypeAdapter(Number).validate_json('"high"')
    ... except ValidationError as error:
    ...     print(one_line(error, "message"))
    message: Input should be a valid number, unable to parse string as a number
    """
    first = error.errors(include_url=False, include_context=False, include_input=False)[0]
    place = ".".join(str(part) for part in first["loc"])[:120]
    problem = first["msg"][:200]
    return InputError(f"{what}, {place}: {problem}" if place else f"{what}: {problem}")
