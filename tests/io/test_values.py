from __future__ import annotations

import numpy as np
import pytest

from palms.errors import FormatError, InputError
from palms.io.values import brief, check_array, locating, null_for_nan, parse_number


@pytest.mark.parametrize(
    "values", [None, {}, [[1], [2, 3]], [[1, None]], [["a", "b"]], [[10**400, 0]], [[[1, 2]]]]
)
def test_check_array_refuses(says, values):
    with pytest.raises(FormatError) as caught:
        check_array(values, "a.json: key", (None, 2))
    assert "\n" not in str(caught.value)
    assert "a.json: key" in str(caught.value)
    says(caught.value)


@pytest.mark.parametrize("cell", ["", "wall", "1_0", "1,5", "0x10", "--1"])
def test_no_numbers(cell):
    assert parse_number(cell) is None


@pytest.mark.parametrize(
    ("cell", "value"), [(" 1.5 ", 1.5), ('"-2e3"', -2000.0), ("+.5", 0.5), ("1e400", np.inf)]
)
def test_numbers(cell, value):
    assert parse_number(cell) == value


def test_null_for_nan_keeps_shape():
    assert null_for_nan([[1.0, np.nan], [np.nan, 2.0]]) == [[1.0, None], [None, 2.0]]


def test_brief_is_brief():
    assert len(brief("x" * 1000)) == 40
    assert "\n" not in brief("a\nb")


def test_locating_names_the_file_once():
    with pytest.raises(FormatError, match=r"^a\.csv: scan: expected a, got b$"), locating("a.csv"):
        raise InputError("scan", expected="a", got="b")
