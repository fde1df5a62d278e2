"""Answers in words that a user understands."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from palms.belief import Estimate
    from palms.floorplan import FloorPlan
    from palms.geometry import FloatArray
    from palms.io import RecordedWalk
    from palms.localizer import Track
    from palms.odometry import Odometry

__all__ = ["at_the_end", "how_sure", "outcome", "summary", "where"]

ROOMY_M = 15.0  # ours: in a larger room or corridor it helps to name a neighbour
NEAR_M = 4.0  # ours: farther rooms are not near
SURE_M = 3.0  # ours: a larger radius says less than a percentage
_HEDGES: dict[str, str] = {
    "searching": ", still searching, so this is a guess",
    "oriented": ", oriented but not localized, so this is a guess",
    "lost": ", lost, so this is a guess",
}
SAME_PLACE_M = 2.0  # INTERFACE: an answer farther off is wrong


def where(plan: FloorPlan, position_m: FloatArray) -> str:
    """Say where a point is: room or corridor, a neighbour where that helps, coordinates.

    Examples
    --------
    >>> from palms import FloorPlan
    >>> where(FloorPlan([[[0, 0], [8, 0]]]), [1.0, 2.04])
    'x 1.0 m, y 2.0 m'
    """
    x, y = (float(v) for v in position_m)
    room = plan.room_at((x, y))
    neighbour = _neighbour(plan, (x, y), room)
    names = [name for name in (room, neighbour and f"near {neighbour}") if name]
    coordinates = f"x {x:.1f} m, y {y:.1f} m"
    return f"{', '.join(names)} ({coordinates})" if names else coordinates


def _neighbour(plan: FloorPlan, point_m: tuple[float, float], room: str | None) -> str | None:
    """Name of the nearest other room, when the point's own is large or it has none."""
    import shapely

    outlines = {each.name: shapely.Polygon(each.polygon_m) for each in plan.rooms}
    if room is not None:
        left, low, right, high = outlines.pop(room).bounds
        if math.hypot(right - left, high - low) < ROOMY_M:
            return None
    away = {name: outline.distance(shapely.Point(point_m)) for name, outline in outlines.items()}
    nearest = min(away, key=lambda name: away[name], default=None)
    return nearest if nearest is not None and away[nearest] <= NEAR_M else None


def how_sure(estimate: Estimate) -> str:
    """Say how sure an answer is.

    Examples
    --------
    >>> from palms import Estimate
    >>> how_sure(Estimate(1.0, radius_95_m=0.62, p_within_2m=1.0))
    'within 0.6 m with 95 %'
    >>> how_sure(Estimate(1.0, radius_95_m=39.0, p_within_2m=0.64))
    'within 2 m with 64 % (95 %: within 39 m)'
    """
    radius = estimate.radius_95_m
    if radius is None:
        return "nothing is known"
    if radius <= SURE_M:
        return f"within {max(radius, 0.1):.1f} m with 95 %"
    share = _percent(estimate.p_within_2m)
    return f"within 2 m with {share} (95 %: within {radius:.0f} m)"


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 0.01 else "less than 1 %"


def outcome(track: Track, plan: FloorPlan, walk: RecordedWalk, odometry: Odometry) -> str:
    """Say when and where a walk was localized, how sure that was, and how far off."""
    step = localized_step(track)
    if step is None:
        oriented = next((i for i, e in enumerate(track) if e.stage != "searching"), None)
        turned = "" if oriented is None else f"oriented after {_after(odometry, oriented)}, but "
        return f"{turned}not localized in {_after(odometry, len(odometry) - 1)}"
    return f"localized after {_after(odometry, step)}: {_answer(track, step, plan, walk)}"


def at_the_end(track: Track, plan: FloorPlan, walk: RecordedWalk, odometry: Odometry) -> str:
    """Say the answer at the end of the walk and whether it counts as localized."""
    last = len(odometry) - 1
    hedge = _HEDGES.get(track.estimates[-1].stage, "")
    return f"at the end, after {_after(odometry, last)}{hedge}: {_answer(track, last, plan, walk)}"


def localized_step(track: Track) -> int | None:
    """Index of the first localized step; None when never."""
    return next((i for i, estimate in enumerate(track) if estimate.is_localized), None)


def error_m(track: Track, step: int, walk: RecordedWalk) -> float | None:
    """Distance from the answer to the reference; None where either is missing."""
    position = track.estimates[step].position_m
    if position is None or not walk.has_reference[step]:
        return None
    x, y = position - walk.reference_m[step]
    return math.hypot(x, y)


def _answer(track: Track, step: int, plan: FloorPlan, walk: RecordedWalk) -> str:
    estimate = track.estimates[step]
    if estimate.position_m is None:
        return "no answer"
    off = error_m(track, step, walk)
    truth = "" if off is None else f"; the truth was {off:.1f} m away"
    return f"{where(plan, estimate.position_m)}; {how_sure(estimate)}{truth}"


def _after(odometry: Odometry, step: int) -> str:
    return f"{odometry.walked_m[step]:.0f} m ({odometry.time_s[step]:.0f} s)"


def summary(tracks: list[Track], walk: RecordedWalk, odometry: Odometry) -> str:
    """Say how several trials came out together; trials that never localized count."""
    from statistics import median

    steps = [localized_step(track) for track in tracks]
    found = [(track, step) for track, step in zip(tracks, steps, strict=True) if step is not None]
    text = f"localized in {len(found)} of {len(tracks)} trials"
    if not found:
        return text
    text += f", in the median after {median(odometry.walked_m[step] for _, step in found):.0f} m"
    off = [error for track, step in found if (error := error_m(track, step, walk)) is not None]
    if not off:
        return text
    wrong = sum(error > SAME_PLACE_M for error in off)
    return f"{text} and {median(off):.1f} m off; {wrong} of {len(off)} more than 2 m off"
