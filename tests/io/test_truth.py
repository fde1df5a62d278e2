from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palms.errors import FormatError, InputError, OutputError
from palms.io.truth import Truth, read_truth, write_truth

finite = st.floats(-1e6, 1e6)
level = st.sampled_from(["", "G", "2", "level, upper", 'a "b"'])
row = st.tuples(finite, finite, finite, st.one_of(finite, st.just(float("nan"))), level)


@settings(derandomize=True, deadline=None, max_examples=50)
@given(st.lists(row, min_size=1, max_size=10))
def test_round_trip(tmp_path_factory, rows):
    t, x, y, heading, levels = zip(*rows, strict=True)
    truth = Truth(t, np.column_stack([x, y]), heading, levels)
    path = tmp_path_factory.mktemp("truth") / "truth.csv"
    write_truth(truth, path)
    again = read_truth(path)
    assert np.array_equal(again.time_s, truth.time_s)
    assert np.array_equal(again.position_m, truth.position_m)
    assert np.array_equal(again.heading_rad, truth.heading_rad, equal_nan=True)
    assert again.level == truth.level


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("", "an empty file"),
        ("t_s,x_m,y_m,heading_rad,level\n", "no row"),
        ("1,2,3\n", "line 1"),
        ("t_s\n1,2,3,4,5,6\n", "line 2"),
        ("1,2,x,0,G\n", "y_m"),
        ("1,2,nan,0,G\n", "y_m"),
        ("1,2,3,inf,G\n", "heading_rad"),
        ("1,,3,0,G\n", "x_m"),
        (b"\x89PNG\x00", "PNG"),
        ('1,2,3,4,"' + "x" * 200_000, "truth"),
    ],
)
def test_bad_files(put, says, text, part):
    with pytest.raises(FormatError) as caught:
        read_truth(put("truth.csv", text))
    says(caught.value, "truth.csv", part)


def test_without_level_and_header(put):
    assert read_truth(put("truth.csv", "1,2,3,4\r\n\r\n2,3,4,\r\n")).level == ("", "")


def test_lengths_differ(says):
    with pytest.raises(InputError) as caught:
        Truth([1, 2], [[1, 2]], [0, 0])
    says(caught.value, "2 positions")


def test_unwritable(unwritable, says):
    with pytest.raises(OutputError) as caught:
        write_truth(Truth([1], [[1, 2]], [0]), unwritable / "truth.csv")
    says(caught.value)
