import numpy as np
import pytest

from palms import Estimate, Stage
from palms.errors import OutputError
from palms.io import write_tum
from palms.localizer import Track


def estimate(t, x, y, heading):
    return Estimate(t, Stage.LOCALIZED, np.array([x, y]), heading)


def test_lines_are_what_trajectory_tools_read(tmp_path):
    headings = [None, 0.0, np.pi / 2, np.pi, -3.0]
    steps = [estimate(0.1 * i, i, -i, h) for i, h in enumerate(headings)]
    write_tum(Track(0, (Estimate(0.0), *steps)), tmp_path / "a.tum")
    table = np.loadtxt(tmp_path / "a.tum")
    assert table.shape == (5, 8)
    assert table[:, 0] == pytest.approx(0.1 * np.arange(5))
    assert table[:, 1:4] == pytest.approx(np.array([[i, -i, 0] for i in range(5)]))
    assert np.linalg.norm(table[:, 4:], axis=1) == pytest.approx(np.ones(5))
    known = [0.0, *headings[1:]]
    assert 2 * np.arctan2(table[:, 6], table[:, 7]) == pytest.approx(known)
    assert table[0, 4:].tolist() == [0, 0, 0, 1]


def test_a_track_without_answers_is_a_file_without_lines(tmp_path):
    write_tum(Track(0, (Estimate(0.5),)), tmp_path / "a.tum")
    lines = (tmp_path / "a.tum").read_text().splitlines()
    assert [line[0] for line in lines] == ["#"]


def test_a_place_that_cannot_be_written_is_said(tmp_path):
    with pytest.raises(OutputError, match="no folder"):
        write_tum(Track(0, ()), tmp_path / "no" / "a.tum")
