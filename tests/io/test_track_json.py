import dataclasses
import json
import math

import numpy as np
import pytest

from palms import Estimate, FloorPlan, OutputError, Room, Settings, Stage, Track
from palms.io.track_json import (
    locate_document,
    settings_document,
    track_document,
    versions,
    write_tracks,
)
from palms.places import Place

PLAN = FloorPlan([[[0, 0], [8, 0]], [[8, 0], [8, 5]]], name="hall", level="2")
KNOWN = Estimate(1.0, Stage.LOCALIZED, np.array([1.5, 2.5]), -math.pi, 7.0, 0.8, 0.9, 0.4, 1.1)


def steps(*estimates):
    return track_document([Track(3, estimates)], PLAN, Settings())["trials"][0]["steps"]


def test_what_is_known_is_written():
    assert steps(KNOWN) == {
        "t_s": [1.0],
        "x_m": [1.5],
        "y_m": [2.5],
        "heading_rad": [math.pi],
        "drift_rad": [pytest.approx(7.0 - 2 * math.pi)],
        "stage": ["localized"],
        "p_within_1m": [0.8],
        "p_within_2m": [0.9],
        "radius_68_m": [0.4],
        "radius_95_m": [1.1],
    }


def test_without_belief_all_is_null_and_probabilities_are_0():
    odd = Estimate(0.5, heading_rad=1.0, drift_rad=1.0, p_within_1m=0.3, radius_68_m=2.0)
    written = steps(odd)
    assert written["t_s"] == [0.5]
    assert written["stage"] == ["searching"]
    for name in ("x_m", "y_m", "heading_rad", "drift_rad", "radius_68_m", "radius_95_m"):
        assert written[name] == [None]
    assert written["p_within_1m"] == written["p_within_2m"] == [0.0]


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_nan_is_never_written(bad):
    fields = {"drift_rad": bad, "heading_rad": bad, "radius_68_m": bad, "p_within_1m": bad}
    for estimate in (
        dataclasses.replace(KNOWN, **fields),
        dataclasses.replace(KNOWN, position_m=np.array([bad, 0.0])),
    ):
        text = json.dumps(steps(estimate), allow_nan=False)
        assert "NaN" not in text
        assert steps(estimate)["p_within_1m"] == [0.0]


def test_rounding_does_not_push_a_probability_over_1():
    assert steps(dataclasses.replace(KNOWN, p_within_2m=1 + 1e-12))["p_within_2m"] == [1.0]


@pytest.mark.parametrize("method", ["palms", "paper", "authors", "uniform"])
def test_all_settings_are_there_and_infinity_is_a_text(method):
    settings = Settings.for_method(method)
    written = settings_document(settings)
    json.dumps(written, allow_nan=False)
    assert written.keys() == {field.name for field in dataclasses.fields(Settings)}
    expected = settings.template.range_sigma_m
    assert float(written["template"]["range_sigma_m"]) == expected


def test_versions_name_what_a_result_depends_on():
    assert versions().keys() >= {"palms", "numpy", "numba", "scipy", "python"}


def test_first_entries_into_the_stages():
    track = Track(
        5, (Estimate(0.5), dataclasses.replace(KNOWN, time_s=2.0), Estimate(3.0, Stage.LOST))
    )
    (trial,) = track_document([track], PLAN, Settings())["trials"]
    assert (trial["seed"], trial["oriented_at_s"], trial["localized_at_s"]) == (5, 2.0, 2.0)


def test_locate_document_names_level_and_room():
    plan = dataclasses.replace(PLAN, rooms=(Room("Hall", [[0, 0], [4, 0], [4, 4], [0, 4]]),))
    places = [Place(1.0, 1.0, 7.0, 0.5, 3.0), Place(6.0, 1.0, 0.0, 0.25, 2.0)]
    document = locate_document(places, plan, "Session_7", Settings())
    assert document["schema"] == "palms-locate/1"
    assert [each["room"] for each in document["candidates"]] == ["Hall", None]
    assert document["candidates"][0] == {
        "x_m": 1.0,
        "y_m": 1.0,
        "drift_rad": pytest.approx(7.0 - 2 * math.pi),
        "p": 0.5,
        "level": "2",
        "room": "Hall",
    }


def test_written_whole_or_not_at_all(tmp_path):
    path = tmp_path / "track.json"
    write_tracks(path, [Track(0, (KNOWN,))], PLAN, Settings())
    before = path.read_bytes()
    assert json.loads(before)["schema"] == "palms-track/1"
    with pytest.raises(OutputError):
        write_tracks(path / "below" / "a.json", [], PLAN, Settings())
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]
