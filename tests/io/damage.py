"""Damaged copies of good files, and what reading one may come to."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import Any

from hypothesis import strategies as st

from palms.errors import PalmsError, PalmsWarning

PIECES = [bytes([b]) for b in b'019e-+.,;"[]{}:nN\n \x00\xff']
_START = 300  # bytes, where most formats have their header

Damage = Callable[[bytes], bytes]


@st.composite
def damage(draw):
    """A function from good to damaged bytes; half of the time near the start."""
    kind = draw(st.sampled_from(["flip", "cut", "drop", "insert", "repeat"]))
    near_start = draw(st.booleans())
    at, other = draw(st.floats(0, 1)), draw(st.floats(0, 1))
    piece = draw(st.one_of(st.sampled_from(PIECES), st.binary(min_size=1, max_size=4)))
    count = draw(st.integers(1, 3))

    def apply(good: bytes) -> bytes:
        i = int(at * min(len(good) - 1, _START if near_start else len(good)))
        j = min(i + 1 + int(other * 20), len(good))
        return {
            "flip": good[:i] + piece * count + good[i + len(piece) * count :],
            "cut": good[:i],
            "drop": good[:i] + good[j:],
            "insert": good[:i] + piece * count + good[i:],
            "repeat": good[:j] + good[i:],
        }[kind]

    return apply


damages = st.lists(damage(), min_size=1, max_size=3)


def damaged(good: bytes, damages: Sequence[Damage]) -> bytes:
    """Good content, damaged once or more."""
    for apply in damages:
        good = apply(good)
    return good


def outcome(read: Callable[[], Any], kind: type, place: object) -> Any:
    """What reading comes to: a value of its kind, or one line that names the place."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PalmsWarning)
        try:
            value = read()
        except PalmsError as error:
            value = error
    assert isinstance(value, kind | PalmsError)
    if isinstance(value, PalmsError):
        assert "\n" not in str(value)
        assert str(place) in str(value)
    return value
