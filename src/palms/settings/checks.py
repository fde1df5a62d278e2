"""What the numbers of a group must be."""

from __future__ import annotations

from palms.errors import SettingsError

__all__ = ["check"]


def check(group: str, **conditions: tuple[bool, str, object]) -> None:
    """Raise for the first condition (holds, expected, got) that does not hold.

    Examples
    --------
    >>> check("start", n_particles=(0 >= 1, "at least 1", 0))
    Traceback (most recent call last):
    palms.errors.SettingsError: setting start.n_particles: expected at least 1, got 0
    """
    for name, (holds, expected, got) in conditions.items():
        if not holds:
            raise SettingsError(f"setting {group}.{name}", expected=expected, got=str(got))
