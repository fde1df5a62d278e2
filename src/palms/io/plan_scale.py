"""How large a drawing or picture is: metres per unit, two known points, or a ratio as 1:100."""

from __future__ import annotations

import math

from palms.errors import InputError
from palms.io.plan_parts import check_scale

__all__ = ["Points", "metres_per_unit"]

Points = tuple[float, float, float, float]


def metres_per_unit(
    scale: float | None, points: Points | None, distance: float | None, what: str, unit: str
) -> float:
    """Return the metres of one unit of a drawing.

    Parameters
    ----------
    scale : float, optional
        Metres per unit. Or else:
    points, distance : optional
        Two points x1, y1, x2, y2 in units, and the metres between them.
    what : str
        What to call the file in a message.
    unit : str
        The name of its unit, as "pixel".

    Raises
    ------
    InputError
        When nothing says it, or it makes no sense.

    Examples
    --------
    >>> metres_per_unit(None, (0, 0, 300, 400), 25.0, "a.png", "pixel")
    0.05
    >>> metres_per_unit(None, None, None, "a.png", "pixel")
    Traceback (most recent call last):
    palms.errors.InputError: a.png: expected its scale, got none; give scale=METRES per pixel, ...
    """
    if scale is not None:
        return check_scale(scale, f"{what}, option scale") or 1.0
    if points is None or distance is None:
        raise InputError(
            what, expected="its scale", got="none",
            fix=f"give scale=METRES per {unit}, or points=x1,y1,x2,y2 in {unit}s and "
            "distance=METRES",
        )  # fmt: skip
    units = math.hypot(points[2] - points[0], points[3] - points[1])
    if not (units > 0 and math.isfinite(units) and math.isfinite(distance) and distance > 0):
        raise InputError(
            f"{what}, options points and distance", expected="two points apart, and metres above 0",
            got=f"{units:g} {unit}s and {distance:g} m",
        )  # fmt: skip
    return distance / units
