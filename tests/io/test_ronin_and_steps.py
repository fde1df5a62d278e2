from __future__ import annotations

import numpy as np
import pytest

from palms.errors import FormatError, InputError
from palms.io import read_walk
from palms.io.ronin import read_ronin
from palms.io.step_heading import read_step_heading

LINE = np.column_stack([np.arange(400) / 200, np.zeros(400)])


def save(path, array):
    np.save(path, array)
    return path


@pytest.mark.parametrize(
    ("array", "part"),
    [
        (np.zeros(8), "shape (8,)"), (np.zeros((9, 3)), "shape (9, 3)"), (LINE[:2], "shape (2, 2)"),
        (np.full((9, 2), np.nan), "NaN"), (np.zeros((9, 2), complex), "complex"),
        (np.array([["a", "b"]] * 5), "<U1"), (1e4 * LINE, "m/s"),
    ],
)  # fmt: skip
def test_arrays_that_are_no_track_are_refused(tmp_path, says, array, part):
    with pytest.raises(FormatError) as caught:
        read_ronin(save(tmp_path / "a.npy", array))
    says(caught.value, "a.npy", part)


def test_objects_are_never_unpickled(tmp_path, says):
    with pytest.raises(FormatError) as caught:
        read_ronin(save(tmp_path / "a.npy", np.array([[{"a": 1}, None]] * 4, dtype=object)))
    says(caught.value, "cannot be read")


def test_a_header_that_promises_too_much_costs_nothing(tmp_path, says):
    content = save(tmp_path / "a.npy", np.zeros((9, 2))).read_bytes()
    (tmp_path / "a.npy").write_bytes(content.replace(b"(9, 2)", b"(9000000000, 2)"))
    with pytest.raises(FormatError) as caught:
        read_ronin(tmp_path / "a.npy")
    says(caught.value, "cannot be read")


def test_too_many_samples_are_refused(tmp_path, monkeypatch, says):
    monkeypatch.setattr("palms.io.ronin.MAX_ROWS", 300)
    with pytest.raises(InputError) as caught:
        read_ronin(save(tmp_path / "a.npy", LINE))
    says(caught.value, "at most 300 samples")


def test_rate_and_spacing(tmp_path):
    path = save(tmp_path / "a.npy", LINE)
    assert read_ronin(path).time_s[-1] == pytest.approx(399 / 200)
    assert read_ronin(path, rate_hz="100").time_s[-1] == pytest.approx(3.99)
    assert len(read_ronin(path, every_s=0)) == 399
    assert not read_ronin(path).has_reference.any()


@pytest.mark.parametrize(
    ("text", "end"),
    [
        ("0.5,0.6,0\n1.0,0.6,1.5708\n", [0.6, 0.6]),
        ("t_ms;step_length_m;heading_deg\n500;0,6;0\n1000;0,6;90\n", [0.6, 0.6]),
        ("heading (deg),t,step\n0,0.5,0.6\n90,1,0.6\n", [0.6, 0.6]),
        ("timestamp_ns,length,yaw_rad\n500000000,0.6,0\n1000000000,0.6,1.5708\n", [0.6, 0.6]),
    ],
)
def test_columns_by_their_names(put, text, end):
    path = put("a.csv", text)
    walk = read_walk(path).odometry("ronin")
    np.testing.assert_allclose(walk.time_s, [0.5, 1.0])
    np.testing.assert_allclose(walk.position_m[-1], end, atol=1e-5)


def test_angles_as_the_user_says(put):
    path = put("a.csv", "t,length,heading\n1,1,0\n2,1,90\n")
    with pytest.raises(InputError, match="give the option angle"):
        read_step_heading(path)
    left = read_step_heading(path, angle="deg").odometry("ronin")
    right = read_step_heading(path, angle="deg", turning="right").odometry("ronin")
    np.testing.assert_allclose(left.position_m[-1], [1, 1], atol=1e-9)
    np.testing.assert_allclose(right.position_m[-1], [1, -1], atol=1e-9)


def test_times_since_1970_count_from_the_first_step(put):
    walk = read_step_heading(put("a.csv", "1700000000.5,1,0\n1700000001,1,0\n1700000002,1,0\n"))
    assert walk.time_s.tolist() == [0.0, 0.5, 1.5]


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("t,length\n1,1\n2,1\n", "no column of heading"), ("1,1,0\n", "at least 2 samples"),
        ("2,1,0\n1,1,0\n", "times that increase"), ("1,1,0\n2,1\n", "line 2"),
        ("1,1,0\n2,far,0\n", "line 2"), ("1,2,3,4\n2,3,4,5\n", "no column of"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_steps_is_said(put, says, text, part):
    with pytest.raises(FormatError) as caught:
        read_step_heading(put("a.csv", text))
    says(caught.value, "a.csv", part)
