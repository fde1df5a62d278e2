"""Answers in words that a user understands."""

from __future__ import annotations

import math
from collections.abc import Sequence
from statistics import median
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from palms.advice import Advice
    from palms.belief import Estimate
    from palms.cli._inputs import Case
    from palms.floorplan import FloorPlan
    from palms.geometry import FloatArray
    from palms.localizer import Track

__all__ = ["HEADINGS", "advised", "at_the_end", "how_sure", "outcome", "row", "summary", "where"]

HEADINGS = ("seed", "localized after", "place", "within 2 m", "95 % within", "off by")

ROOMY_M = 15.0  # ours: in a larger room or corridor it helps to name a neighbour
NEAR_M = 4.0  # ours: farther rooms are not near
SURE_M = 3.0  # ours: a larger radius says less than a percentage
_HEDGES: dict[str, str] = {
    "searching": ", still searching, so this is a guess",
    "oriented": ", oriented but not localized, so this is a guess",
    "lost": ", lost, so this is a guess",
}
SAME_PLACE_M = 2.0  # ours: an answer farther off is wrong


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
    'within 2 m with 64 %, within 39 m with 95 %'
    """
    radius = estimate.radius_95_m
    if radius is None:
        return "nothing is known"
    if radius <= SURE_M:
        return f"within {max(radius, 0.1):.1f} m with 95 %"
    return f"within 2 m with {_percent(estimate.p_within_2m)}, within {radius:.0f} m with 95 %"


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 0.01 else "< 1 %"


def advised(advice: Advice) -> str:
    """Say how much a scan tells.

    Examples
    --------
    >>> from palms.advice import Advice, Gap, View
    >>> advised(Advice(View(12, False, ()), 3, 0.9))
    'What the scan tells: 3 places hold 90 % of it; 12 walls, seen all round.'
    >>> advised(Advice(View(1, True, (Gap(0.0, 3.1416),)), 40, 0.9))
    'What the scan tells: 40 places hold 90 % of it; 1 wall, seen in 50 % of all directions.'
    """
    view = advice.view
    places = f"{advice.n_places} {'place holds' if advice.n_places == 1 else 'places hold'}"
    walls = f"{view.n_walls} {'wall' if view.n_walls == 1 else 'walls'}"
    ways = " that all run one way" if view.one_way and view.n_walls > 1 else ""
    seen = "all round" if not view.gaps else f"in {_percent(1 - view.unseen)} of all directions"
    return f"What the scan tells: {places} 90 % of it; {walls}{ways}, seen {seen}."


def outcome(track: Track, case: Case) -> tuple[str, str]:
    """Say when and where a walk was localized; then how sure that was, and how far off.

    Returns
    -------
    tuple of str
        Two sentences; the second is empty where the walk was never localized.
    """
    step = localized_step(track)
    if step is not None:
        return _answer(f"Localized after {_after(case, step)}", track, step, case)
    oriented = next((i for i, e in enumerate(track) if e.stage != "searching"), None)
    turned = "" if oriented is None else f"Oriented after {_after(case, oriented)}, but "
    text = f"{turned}not localized in {_after(case, len(track) - 1)}."
    return text[:1].upper() + text[1:], ""


def at_the_end(track: Track, case: Case) -> tuple[str, str]:
    """Say the answer at the end of the walk and whether it counts; then as `outcome`."""
    last = len(track) - 1
    hedge = _HEDGES.get(track.estimates[-1].stage, "")
    return _answer(f"At the end, after {_after(case, last)}{hedge}", track, last, case)


def localized_step(track: Track) -> int | None:
    """Index of the first localized step; None when never."""
    return next((i for i, estimate in enumerate(track) if estimate.is_localized), None)


def error_m(track: Track, step: int, case: Case) -> float | None:
    """Distance from the answer to the reference; None where either is missing.

    It is infinite where the answer is on another level.
    """
    position = track.estimates[step].position_m
    if position is None or not case.walk.has_reference[step]:
        return None
    level = track.estimates[step].level
    if level is not None and case.walk.truth is not None and case.walk.truth.level[step] != level:
        return math.inf
    x, y = position - case.walk.reference_m[step]
    return math.hypot(x, y)


def _answer(when: str, track: Track, step: int, case: Case) -> tuple[str, str]:
    estimate = track.estimates[step]
    if estimate.position_m is None:
        return f"{when}: no answer.", ""
    off = error_m(track, step, case)
    truth = (
        "" if off is None else f" The truth was {_metres(off)}{'' if off == math.inf else ' away'}."
    )
    return f"{when}: {_place(estimate, case)}.", f"How sure: {how_sure(estimate)}.{truth}"


def _place(estimate: Estimate, case: Case) -> str:
    """Say where an answer is, with its level where there are several."""
    assert estimate.position_m is not None
    place = where(case.plan_of(estimate.level), estimate.position_m)
    if estimate.level is None:
        return place
    return f"level {estimate.level} ({_percent(estimate.p_level)}), {place}"


def _metres(off_m: float) -> str:
    return f"{off_m:.1f} m" if math.isfinite(off_m) else "on another level"


def _after(case: Case, step: int) -> str:
    odometry = case.odometry
    return f"{odometry.walked_m[step]:.0f} m ({odometry.time_s[step]:.0f} s)"


def row(track: Track, case: Case) -> list[str]:
    """Return a line of the table of trials; see `HEADINGS`."""
    step = localized_step(track)
    if step is None:
        return [str(track.seed), "never", "-", "-", "-", "-"]
    estimate, off = track.estimates[step], error_m(track, step, case)
    radius, position = estimate.radius_95_m, estimate.position_m
    return [
        str(track.seed),
        _after(case, step),
        "-" if position is None else _place(estimate, case),
        _percent(estimate.p_within_2m),
        "-" if radius is None else f"{radius:.1f} m",
        "-" if off is None else _metres(off),
    ]


def summary(tracks: Sequence[Track], case: Case) -> str:
    """Say how several trials came out together; trials that never localized count."""
    steps = [localized_step(track) for track in tracks]
    found = [(track, step) for track, step in zip(tracks, steps, strict=True) if step is not None]
    text = f"Localized in {len(found)} of {len(tracks)} trials"
    if not found:
        return f"{text}."
    walked = median(case.odometry.walked_m[step] for _, step in found)
    off = [error for track, step in found if (error := error_m(track, step, case)) is not None]
    if not off:
        return f"{text}, in the median after {walked:.0f} m."
    wrong = sum(error > SAME_PLACE_M for error in off)
    middle = median(off)
    away = f"{middle:.1f} m off" if math.isfinite(middle) else "on another level"
    return (
        f"{text}, in the median after {walked:.0f} m and {away}; "
        f"{wrong} of {len(off)} more than 2 m off."
    )
