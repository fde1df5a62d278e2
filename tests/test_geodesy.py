from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palms import Estimate, FloorPlan, Origin, Settings, Track
from palms.errors import InputError
from palms.io.track_json import locate_document, track_document
from palms.places import Place


@settings(derandomize=True, deadline=None)
@given(st.floats(-180, 180), st.floats(-85, 85), st.floats(-2500, 2500), st.floats(-2500, 2500))
def test_there_and_back_is_a_tenth_of_a_millimetre(lon, lat, x, y):
    origin = Origin(lon, lat)
    assert origin.to_local(origin.to_lonlat([x, y])) == pytest.approx([x, y], abs=1e-4)


@pytest.mark.parametrize(
    ("lat", "east", "north"),
    [
        (0.0, 111_319.491, 110_574.276),
        (45.0, 78_846.806, 111_131.745),
        (60.0, 55_800.0, 111_412.24),
    ],
)
def test_a_degree_is_as_long_as_the_tables_say(lat, east, north):
    """Lengths of a degree on WGS84; here of its thousandth, where the curve does not show."""
    place = Origin(10.0, lat).to_local([[10.001, lat], [10.0, lat + 0.001]])
    assert place[0, 0] == pytest.approx(east / 1000, abs=0.002)
    assert place[1, 1] == pytest.approx(north / 1000, abs=0.01)


@pytest.mark.parametrize("place", [(np.nan, 0), (0, 91), (1000, 0), (0, np.inf)])
def test_what_is_no_place_on_earth(place):
    with pytest.raises(InputError, match="longitude and latitude"):
        Origin(*place)


def test_answers_come_back_as_longitude_and_latitude():
    origin = Origin(30.38, 60.007)
    plan = FloorPlan([[[0, 0], [8, 0]]], origin=origin)
    track = Track(0, (Estimate(0.5), Estimate(1.0, position_m=np.array([3.0, 4.0]))))
    steps = track_document([track], plan, Settings())["trials"][0]["steps"]
    assert steps["lon"][0] is None
    here = [steps["lon"][1], steps["lat"][1]]
    assert origin.to_local(here) == pytest.approx([3, 4], abs=0.002)
    document = locate_document([Place(3.0, 4.0, 0, 1.0, 1.0)], plan, "s", Settings())
    assert [document["candidates"][0][key] for key in ("lon", "lat")] == here
    plain = FloorPlan([[[0, 0], [8, 0]]])
    assert "lon" not in track_document([track], plain, Settings())["trials"][0]["steps"]
