"""Options of readers given as text."""

from __future__ import annotations

import inspect
from typing import Literal

import pytest

from palms.errors import InputError
from palms.io import FLOORPLANS, ODOMETRY, SCANS, formats, read_any
from palms.io.options import options_of, parse_options


def read(
    path: str,
    scale: float | None = None,
    *,
    level: str | int | None = None,
    count: int = 3,
    flip: bool = False,
    frame: Literal["auto", "metres"] = "auto",
    corner: tuple[float, float] | None = None,
    layers: tuple[str, ...] = (),
    untyped=1.5,
):
    return path


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("scale=1e-3", 0.001),
        ("level=2", "2"),
        ("count=4", 4),
        ("flip=yes", True),
        ("flip=off", False),
        ("frame=metres", "metres"),
        ("corner=1, 2.5", (1.0, 2.5)),
        ("layers=A-WALL,A-DOOR", ("A-WALL", "A-DOOR")),
        ("untyped=2", 2.0),
        ("level=a=b", "a=b"),
    ],
)
def test_values_have_the_types_that_the_reader_asks_for(text, value):
    (found,) = parse_options(read, [text], "option").values()
    assert found == value
    assert type(found) is type(value)


def test_hyphens_stand_for_underscores():
    def other(path, class_property=None): ...

    assert parse_options(other, ["class-property=kind"], "option") == {"class_property": "kind"}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("scale", "name=value"),
        ("colour=red", "one of scale, level, count"),
        ("scale=wide", "scale: expected a finite number, got 'wide'"),
        ("scale=nan", "a finite number"),
        ("count=1.5", "a whole number"),
        ("flip=perhaps", "yes or no"),
        ("frame=feet", "one of auto, metres"),
        ("corner=1", "2 values between commas"),
        ("corner=1,x", "a finite number"),
    ],
)
def test_what_does_not_fit_is_said(says, text, words):
    with pytest.raises(InputError) as caught:
        parse_options(read, [text], "option of format x")
    says(caught.value, "option of format x", words)


def test_a_format_without_options_says_so(put):
    with pytest.raises(InputError, match="it has no options"):
        read_any(SCANS, put("a.json", [[[2, -2], [2, 2]]]), None, ["scale=1"])


@pytest.mark.parametrize("group", [FLOORPLANS, SCANS, ODOMETRY])
def test_every_option_of_ours_can_be_left_out(group):
    for reader in formats(group):
        for option in options_of(reader.read):
            assert option.default is not inspect.Parameter.empty, (reader.name, option.name)
