"""What can go wrong, as one tree.

::

    PalmsError
    ├── InputError         a file or value is not what was asked for
    │   └── FormatError    a file's content is not of the format it should be
    ├── SettingsError      a setting is unknown or out of range
    └── OutputError        a result could not be written

Failure that is normal is no exception: a phone that is not localized yet is an
`Estimate` whose ``is_localized`` is False.
"""

from __future__ import annotations

__all__ = [
    "FormatError",
    "InputError",
    "OutputError",
    "PalmsError",
    "PalmsWarning",
    "SettingsError",
]


class PalmsError(Exception):
    """Any mistake that PALMS can name; its text is one line for a user.

    Parameters
    ----------
    what : str
        What is wrong, with the name of the file or value.
    expected, got, fix : str, optional
        What was expected, what was there instead, how to mend it.

    Examples
    --------
    >>> str(PalmsError("plan.csv line 3", expected="4 numbers", got="2", fix="add x2,y2"))
    'plan.csv line 3: expected 4 numbers, got 2; add x2,y2'
    """

    def __init__(self, what: str, *, expected: str = "", got: str = "", fix: str = "") -> None:
        comparison = ", ".join(
            f"{word} {text}" for word, text in (("expected", expected), ("got", got)) if text
        )
        line = f"{what}: {comparison}" if comparison else what
        super().__init__(" ".join((f"{line}; {fix}" if fix else line).split()))


class InputError(PalmsError, ValueError):
    """A file or value is not what was asked for."""


class FormatError(InputError):
    """A file's content is not of the format it should be."""


class SettingsError(PalmsError, ValueError):
    """A setting is unknown or out of its range."""


class OutputError(PalmsError, OSError):
    """A result could not be written."""


class PalmsWarning(UserWarning):
    """Something was odd but could be worked with; said once."""
