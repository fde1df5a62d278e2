"""Options of readers, as a program or the command line gives them."""

from __future__ import annotations

from palms.errors import InputError
from palms.io.values import brief, parse_number

__all__ = ["choice_option", "number_option"]


def number_option(value: object, name: str, low: float, high: float) -> float:
    """Return the number that an option gives, also as text; within bounds.

    Raises
    ------
    InputError
        When it is no number, or out of bounds.

    Examples
    --------
    >>> number_option("0.7", "step_m", 0.1, 2.0)
    0.7
    """
    number = parse_number(value) if isinstance(value, str) else value
    if isinstance(number, bool) or not isinstance(number, int | float) or not low <= number <= high:
        raise InputError(
            f"option {name}", expected=f"a number from {low:g} to {high:g}", got=brief(value)
        )
    return float(number)


def choice_option(value: object, name: str, choices: tuple[str, ...]) -> str:
    """Return the word that an option gives.

    Raises
    ------
    InputError
        When it is none of the choices.

    Examples
    --------
    >>> choice_option("z", "up", ("y", "z"))
    'z'
    """
    if not isinstance(value, str) or value not in choices:
        raise InputError(
            f"option {name}", expected=f"one of {', '.join(choices)}", got=brief(value)
        )
    return value
