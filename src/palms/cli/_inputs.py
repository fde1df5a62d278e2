"""From what the user named to values."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from palms.settings import Settings

__all__ = ["make_settings", "scan_name"]


def make_settings(
    method: str, cell_size_m: float | None = None, particles: int | None = None
) -> Settings:
    """Return the settings of a method with the numbers that the user gave.

    Raises
    ------
    SettingsError
        When there is no such method, or a number is out of its range.

    Examples
    --------
    >>> make_settings("paper", particles=500).start.n_particles
    500
    """
    from palms.settings import Settings

    settings = Settings.for_method(method)
    if cell_size_m is not None:
        settings = replace(settings, raster=replace(settings.raster, cell_size_m=cell_size_m))
    return settings if particles is None else settings.with_particles(particles)


def scan_name(path: Path) -> str:
    """Return what to call a scan: its session's folder, else its file.

    Examples
    --------
    >>> scan_name(Path("walk/Session_7/detectedPlanes.json")), scan_name(Path("scan.json"))
    ('Session_7', 'scan')
    """
    place = path.resolve()
    if place.is_dir():
        return place.name
    return place.parent.name if place.parent.name.startswith("Session_") else place.stem
