"""What counts as a wall among points, and how depth is trusted."""

from __future__ import annotations

from dataclasses import dataclass

from palms.errors import SettingsError

__all__ = ["ExtractionSettings"]


@dataclass(frozen=True, slots=True)
class ExtractionSettings:
    """Every number of the extraction.

    Parameters
    ----------
    low_m, high_m : float
        Heights above the floor between which walls are looked for: above skirtings and
        seats, below door frames and lamps (ours).
    cell_m : float
        Side of the columns that points are gathered in (ours: thrice the noise of a
        phone's LiDAR at 1 m).
    min_height_m : float
        Columns whose points reach over less are no wall: tables, chairs (ours).
    fill_share : float
        Share of the heights between the lowest and the highest point of a column that
        hold points (ours).
    reach_down_m : float
        Walls come down to this height above the floor or lower; beams, ducts and lintels
        do not (ours).
    clear_share : float
        On one side at least, the strip beside a wall holds less than this share of what
        the wall itself holds: a wall stands out, clutter does not (ours).
    off_m : float
        Columns this near to a line belong to it (ours).
    straight_m : float
        How far pieces of a wall may be off its line; doors and panels that are set back
        further are walls of their own (ours).
    gap_m : float
        Walls end where nothing is seen for longer (ours: less than a doorway).
    min_length_m : float
        Shorter walls are left out (ours).
    apart_m : float
        Walls that run beside a longer one nearer than this are its noise (ours: less
        than the thickness of a partition).
    corner_m : float
        Ends this near to where two walls meet are moved there (ours).
    range_m : float
        Depth beyond is not used; up to it, a ray shows that nothing is there (the
        maker's figure for phones: 5 m).
    grazing_rad : float
        Pixels of surfaces seen at a larger incidence are edges between two surfaces
        (ours).
    margin_m, margin_share : float
        What is taken off a ray that shows empty space, once and per metre of range
        (ours: twice the noise of a phone's LiDAR).

    Examples
    --------
    >>> ExtractionSettings().min_length_m
    0.4
    >>> ExtractionSettings(cell_m=0.0)
    Traceback (most recent call last):
    palms.errors.SettingsError: setting extraction.cell_m: expected 0.01 to 0.2 m, got 0.0
    """

    low_m: float = 0.3
    high_m: float = 2.2
    cell_m: float = 0.03
    min_height_m: float = 0.8
    fill_share: float = 0.5
    reach_down_m: float = 1.3
    clear_share: float = 0.3
    off_m: float = 0.05
    straight_m: float = 0.015
    gap_m: float = 0.3
    min_length_m: float = 0.4
    apart_m: float = 0.09
    corner_m: float = 0.15
    range_m: float = 5.0
    grazing_rad: float = 1.4
    margin_m: float = 0.02
    margin_share: float = 0.01

    def __post_init__(self) -> None:
        bounds = {
            "low_m": (0.0, 5.0),
            "high_m": (self.low_m + self.min_height_m, self.low_m + 3.0),
            "cell_m": (0.01, 0.2),
            "min_height_m": (0.2, 3.0),
            "fill_share": (0.0, 1.0),
            "reach_down_m": (self.low_m, 5.0),
            "clear_share": (0.0, 1.0),
            "off_m": (0.01, 0.5),
            "straight_m": (0.002, 0.5),
            "gap_m": (0.05, 5.0),
            "min_length_m": (0.1, 10.0),
            "apart_m": (0.0, 1.0),
            "corner_m": (0.0, 1.0),
            "range_m": (0.5, 100.0),
            "grazing_rad": (0.5, 1.56),
            "margin_m": (0.0, 1.0),
            "margin_share": (0.0, 0.5),
        }
        for name, (low, high) in bounds.items():
            value = getattr(self, name)
            if not low <= value <= high:
                unit = name.rpartition("_")[2] if name.endswith(("_m", "_rad")) else ""
                raise SettingsError(
                    f"setting extraction.{name}",
                    expected=f"{low:g} to {high:g} {unit}".strip(),
                    got=str(value),
                )
