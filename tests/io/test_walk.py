from __future__ import annotations

import numpy as np
import pytest

from palms.errors import InputError
from palms.io.truth import Truth
from palms.io.walk import RecordedWalk
from palms.odometry import Odometry

VIO = Odometry([1, 2], [[1, 0], [2, 0]])
INERTIAL = Odometry([1, 2], [[1, 0], [2, 0]], frame="own", source="inertial")


def test_needs_an_odometry(says):
    with pytest.raises(InputError) as caught:
        RecordedWalk()
    says(caught.value, "neither")


def test_both_share_their_times(says):
    with pytest.raises(InputError) as caught:
        RecordedWalk(arkit=VIO, ronin=Odometry([1, 3], [[1, 0], [2, 0]]))
    says(caught.value, "the same times")


@pytest.mark.parametrize("reference", [[[1, 2]], [1, 2], [[np.inf, 0], [0, 0]]])
def test_reference_has_a_row_for_each_sample(says, reference):
    with pytest.raises(InputError) as caught:
        RecordedWalk(arkit=VIO, reference_m=reference)
    says(caught.value, "reference")


def test_without_reference_all_rows_are_nan():
    walk = RecordedWalk.of(INERTIAL)
    assert np.isnan(walk.reference_m).all()
    assert walk.reference_m.shape == (2, 2)
    assert walk.sources == ("ronin",)


def test_is_frozen():
    walk = RecordedWalk.of(VIO)
    with pytest.raises(ValueError, match="read-only"):
        walk.reference_m[0] = 1


def test_truth_has_the_walks_clock(says):
    with pytest.raises(InputError) as caught:
        RecordedWalk(arkit=VIO, truth=Truth([1, 2.5], [[0, 0], [0, 0]], [0, 0]))
    says(caught.value, "2 s at sample 1", "2.5 s")
