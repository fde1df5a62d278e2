"""What one plane of ``detectedPlanes.json`` must hold; loaded only when planes are read."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from palms.errors import FormatError
from palms.io.values import brief

__all__ = ["HistoryPlane", "OlderPlane", "parse_plane"]

Number = Annotated[float, Field(allow_inf_nan=False)]
Vector = Annotated[list[Number], Field(min_length=3, max_length=3)]
Row = Annotated[list[Number], Field(min_length=4, max_length=4)]
Matrix = Annotated[list[Row], Field(min_length=4, max_length=4)]


class HistoryPlane(BaseModel):
    """A plane with the history of its centre and extent; the last of each counts."""

    model_config = ConfigDict(extra="ignore", frozen=True)

    anchorTransform: Matrix  # noqa: N815
    centers: Annotated[list[Vector], Field(min_length=1)]
    extents: Annotated[list[Vector], Field(min_length=1)]

    @property
    def center(self) -> list[float]:
        """Centre x, y, z in the anchor's frame."""
        return self.centers[-1]

    @property
    def extent(self) -> list[float]:
        """Width, height and rotation about the anchor's y axis."""
        return self.extents[-1]


class OlderPlane(BaseModel):
    """A plane of the older form, without histories."""

    model_config = ConfigDict(extra="ignore", frozen=True)

    anchorTransform: Matrix  # noqa: N815
    planeCenter: Vector  # noqa: N815
    planeExtent: Vector  # noqa: N815

    @property
    def center(self) -> list[float]:
        """Centre x, y, z in the anchor's frame."""
        return self.planeCenter

    @property
    def extent(self) -> list[float]:
        """Width, height and rotation about the anchor's y axis."""
        return self.planeExtent


def parse_plane(plane: dict[str, Any], what: str) -> HistoryPlane | OlderPlane:
    """Return a checked plane, or say in one line which field of it is wrong.

    Parameters
    ----------
    plane : dict
        As it stands in the file.
    what : str
        File and index of the plane, for the message.

    Raises
    ------
    FormatError
        When a field is missing or holds something else.

    Examples
    --------
    >>> parse_plane({"planeCenter": [0, 0, 0], "planeExtent": [1, 2, 0]}, "a.json plane 0")
    Traceback (most recent call last):
    palms.errors.FormatError: a.json plane 0, anchorTransform: expected a 4x4 matrix as nested ...
    """
    older = "planeCenter" in plane and "centers" not in plane
    try:
        return OlderPlane.model_validate(plane) if older else HistoryPlane.model_validate(plane)
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False)[0]
        field = str(first["loc"][0])
        where = field + "".join(f"[{part}]" for part in first["loc"][1:])
        missing = first["type"] == "missing"
        raise FormatError(
            f"{what}, {where}",
            expected="a 4x4 matrix as nested rows"
            if field == "anchorTransform"
            else "lists of 3 finite numbers",
            got="nothing" if missing else brief(first["input"]),
            fix="record or export the scan again",
        ) from None
