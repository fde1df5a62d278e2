from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palms.errors import FormatError, InputError, OutputError
from palms.io.label import Label, read_label, write_label

finite = st.floats(-1e6, 1e6)


@settings(derandomize=True, deadline=None, max_examples=50)
@given(finite, finite, st.floats(-math.pi, math.pi, exclude_min=True))
def test_round_trip_is_exact(tmp_path_factory, x, y, drift):
    path = tmp_path_factory.mktemp("label") / "label.txt"
    write_label(Label((x, y), drift), path)
    again = read_label(path)
    assert again.position_m.tolist() == [x, y]
    assert again.drift_rad == drift


@pytest.mark.parametrize(
    "text", ["1, 2, 0.5", "1,2,0.5\n", "\n 1 2 0.5 \r\nmore", "(1, 2, 0.5)", "\ufeff1\t2\t0.5"]
)
def test_ways_to_write_it(put, text):
    label = read_label(put("label.txt", text))
    assert (label.position_m.tolist(), label.drift_rad) == ([1, 2], 0.5)


def test_drift_is_brought_into_its_range(put):
    """The authors' labels exceed pi."""
    drift = read_label(put("label.txt", "41.36220,46.47087,3.28121899")).drift_rad
    assert drift == pytest.approx(3.28121899 - 2 * math.pi)


@pytest.mark.parametrize(
    "text", ["", "1, 2", "1, 2, 3, 4", "x, y, theta", "1, 2, nan", "1, 2, 1e400", b"\xff\x00", ","]
)
def test_bad_files(put, says, text):
    with pytest.raises(FormatError) as caught:
        read_label(put("label.txt", text))
    says(caught.value, "label.txt")


def test_not_finite(says):
    with pytest.raises(InputError) as caught:
        Label((0, 0), math.nan)
    says(caught.value)


def test_unwritable(unwritable, says):
    with pytest.raises(OutputError) as caught:
        write_label(Label((1, 2), 0), unwritable / "label.txt")
    says(caught.value)
