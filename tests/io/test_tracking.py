from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palms.errors import FormatError, InputError, OutputError
from palms.io.tracking import FORMAT, read_tracking, walk_file, write_tracking
from palms.io.truth import Truth, write_truth
from palms.io.walk import RecordedWalk
from palms.odometry import Odometry


@pytest.fixture
def walk(put, walk_content) -> RecordedWalk:
    return read_tracking(put("walk.json", walk_content))


def test_arkit_is_stored_negated_and_in_the_scans_frame(walk):
    odometry = walk.odometry("arkit")
    assert odometry.position_m[:, 0].tolist() == list(range(1, 10))
    assert (odometry.frame, odometry.source) == ("scan", "vio")
    assert not np.signbit(odometry.position_m).any()


def test_ronin_has_a_frame_of_its_own(walk):
    odometry = walk.odometry("ronin")
    np.testing.assert_allclose(odometry.position_m[:, 1], 1.1 * np.arange(1, 10))
    assert (odometry.frame, odometry.source) == ("own", "inertial")


def test_time_is_the_running_sum_and_the_first_move_starts_at_the_origin(walk):
    assert walk.time_s.tolist() == [12.5 + 0.5 * i for i in range(9)]
    assert walk.odometry().displacements_m[0].tolist() == [1, 0]


def test_reference_rows_belong_to_the_last_samples(walk):
    """Of 9 samples the reference has 3 rows: the start, then samples 7 and 8 (from 0)."""
    assert walk.has_reference.tolist() == [False] * 7 + [True] * 2
    assert walk.reference_m[7:].tolist() == [[8, 10], [9, 10]]
    assert walk.start_m.tolist() == [0, 10]
    assert walk.ahead_m.tolist() == [5, 10]


def test_an_uptime_is_no_session_name(walk):
    assert walk.session == ()
    assert walk.building_id == "E2"


@pytest.mark.parametrize(
    ("session_id", "name", "expected"),
    [
        (1717523676, "walk.json", ("1717523676",)),
        (1717523676.0, "walk.json", ("1717523676",)),
        ("Session_17", "walk.json", ("17",)),
        ("17", "walk.json", ("17",)),
        ("0017", "walk.json", ("0017",)),
        ("118531.105", "walk.json", ()),
        ("first try", "walk.json", ("first try",)),
        (None, "B.geojson.csv_Session_1717.json", ("1717",)),
        (17, "B_Session_17.json", ("17",)),
        (118531.1, "Session_17_b.json", ("17", "17_b")),
        (True, "walk.json", ()),
        ([1], "walk.json", ()),
        ("", "walk.json", ()),
        (1e400, "walk.json", ()),
    ],
)
def test_session_names(put, walk_content, session_id, name, expected):
    text = json.dumps({**walk_content, "session_id": session_id}).replace("Infinity", "1e400")
    walk = read_tracking(put(name, text))
    assert walk.session == expected
    assert walk.odometry("ronin").session == expected


def test_one_source_is_enough(put, walk_content, says):
    del walk_content["RoNIN_raw_2D"]
    walk = read_tracking(put("a.json", walk_content))
    assert walk.sources == ("arkit",)
    with pytest.raises(InputError) as caught:
        walk.odometry("ronin")
    says(caught.value, "a.json", "'ronin'")
    with pytest.raises(InputError):
        walk.odometry("wheel")


@pytest.mark.parametrize("key", ["ARKit_PF", "starting_vector", "session_id", "building_id"])
def test_what_may_be_missing(put, walk_content, key):
    del walk_content[key]
    assert len(read_tracking(put("a.json", walk_content))) == 9


def test_first_interval_may_be_zero(put, walk_content):
    walk_content["time_intervals"][0] = 0
    assert read_tracking(put("a.json", walk_content)).time_s[0] == 0


def test_rows_of_null_are_no_reference(put, walk_content):
    walk_content["ARKit_PF"] = [None, [None, None], [9, 10]]
    walk = read_tracking(put("a.json", walk_content))
    assert walk.has_reference.tolist() == [False] * 8 + [True]
    assert walk.start_m.tolist() == [0, 10]


def change(key, value):
    return lambda content: content.__setitem__(key, value)


@pytest.mark.parametrize(
    ("damage", "parts"),
    [
        (lambda c: c.pop("time_intervals"), ["time_intervals"]),
        (lambda c: (c.pop("ARKit_raw_2D"), c.pop("RoNIN_raw_2D")), ["neither"]),
        (lambda c: c["time_intervals"].pop(), ["ARKit_raw_2D", "8 rows", "got 9"]),
        (lambda c: c["ARKit_raw_2D"].pop(), ["ARKit_raw_2D", "9 rows", "got 8"]),
        (lambda c: c["RoNIN_raw_2D"].pop(), ["RoNIN_raw_2D", "9 rows", "got 8"]),
        (lambda c: c["ARKit_PF"].pop(), ["ARKit_PF", "3 rows", "got 2"]),
        (lambda c: c["time_intervals"].__setitem__(4, -0.5), ["-0.5 at sample 4"]),
        (lambda c: c["time_intervals"].__setitem__(4, 0), ["0 at sample 4"]),
        (lambda c: c["time_intervals"].__setitem__(0, -1), ["-1 at sample 0"]),
        (lambda c: c["time_intervals"].__setitem__(4, 1e-300), ["increase"]),
        (lambda c: c["time_intervals"].__setitem__(4, 1e308), ["a.json"]),
        (lambda c: c["time_intervals"].__setitem__(4, float("nan")), ["NaN", "row 4"]),
        (lambda c: c["ARKit_raw_2D"].__setitem__(3, [float("nan"), 0]), ["NaN", "row 3"]),
        (lambda c: c["ARKit_raw_2D"].__setitem__(3, [1e9, 0]), ["1e+09 m at sample"]),
        (lambda c: c["ARKit_raw_2D"].__setitem__(3, [1e308, -1e308]), ["at sample"]),
        (lambda c: c["ARKit_raw_2D"].__setitem__(3, [1]), ["ARKit_raw_2D"]),
        (change("ARKit_raw_2D", {"x": 1}), ["ARKit_raw_2D"]),
        (change("time_intervals", 3), ["time_intervals"]),
        (change("time_intervals", []), ["got 9"]),
        (change("ARKit_PF", "none"), ["ARKit_PF"]),
        (change("ARKit_PF", [[1, 2], 3, 4]), ["ARKit_PF"]),
        (change("starting_vector", [[1, 2]]), ["starting_vector"]),
        (change("facing_rad", [0.0]), ["facing_rad"]),
    ],
)
def test_what_is_wrong_is_said(put, says, walk_content, damage, parts):
    damage(walk_content)
    with pytest.raises(FormatError) as caught:
        read_tracking(put("a.json", walk_content))
    says(caught.value, "a.json", *parts)


def test_one_sample(put, says):
    with pytest.raises(FormatError) as caught:
        read_tracking(put("a.json", {"ARKit_raw_2D": [[1, 0]], "time_intervals": [1.0]}))
    says(caught.value, "a.json", "at least 2 samples", "got 1")


@pytest.mark.parametrize("content", ["", "[]", "3", '{"ARKit_raw_2D": [[1,', b"\x00\x01", "{}"])
def test_wrong_content(put, says, content):
    with pytest.raises(FormatError) as caught:
        read_tracking(put("a.json", content))
    says(caught.value, "a.json")


def test_folder_of_a_walk(put, walk_content):
    path = put("walk/a.json", walk_content)
    put("walk/events.json", "[]")
    put("walk/notes.json", '{"by": "me"}')
    assert walk_file(path.parent) == path
    assert read_tracking(path.parent).path == path


def test_folder_without_or_with_several_walks(put, says, tmp_path, walk_content):
    with pytest.raises(InputError) as caught:
        read_tracking(tmp_path)
    says(caught.value, "none")
    put("a.json", walk_content)
    put("b.json", walk_content)
    with pytest.raises(InputError) as caught:
        read_tracking(tmp_path)
    says(caught.value, "a.json, b.json")


def truth_of(walk: RecordedWalk) -> Truth:
    n = len(walk)
    return Truth(walk.time_s, np.arange(2.0 * n).reshape(n, 2), np.full(n, np.nan), ["G"] * n)


def test_truth_beside_the_walk_is_the_reference(put, walk_content):
    path = put("a.json", walk_content)
    truth = truth_of(read_tracking(path))
    write_truth(truth, path.with_name("truth.csv"))
    walk = read_tracking(path)
    assert walk.has_reference.all()
    assert np.array_equal(walk.reference_m, truth.position_m)
    assert walk.truth.level == ("G",) * 9
    assert walk.start_m.tolist() == [0, 10]


@pytest.mark.parametrize("rows", [slice(1, None), slice(None, None, -1)])
def test_truth_of_another_walk(put, says, walk_content, rows):
    path = put("a.json", walk_content)
    truth = truth_of(read_tracking(path))
    other = Truth(truth.time_s[rows], truth.position_m[rows], truth.heading_rad[rows])
    write_truth(other, path.with_name("truth.csv"))
    with pytest.raises(FormatError) as caught:
        read_tracking(path)
    says(caught.value, "a.json", "truth.csv of another walk")


def test_writing_beside_the_truth_of_another_walk(tmp_path, walk, says):
    write_truth(truth_of(walk), tmp_path / "truth.csv")
    with pytest.raises(OutputError) as caught:
        write_tracking(walk, tmp_path / "b.json")
    says(caught.value, "truth.csv")


def test_unwritable(unwritable, walk, says):
    with pytest.raises(OutputError) as caught:
        write_tracking(walk, unwritable / "a.json")
    says(caught.value)


def test_a_walk_that_starts_elsewhere_is_not_written(tmp_path, says):
    walk = RecordedWalk.of(Odometry([1, 2], [[5, 5], [6, 5]], start_m=[4, 5]))
    with pytest.raises(InputError) as caught:
        write_tracking(walk, tmp_path / "a.json")
    says(caught.value, "origin")


def same_odometry(a: Odometry | None, b: Odometry | None) -> None:
    assert (a is None) == (b is None)
    if a is None or b is None:
        return
    np.testing.assert_allclose(a.time_s, b.time_s, rtol=0, atol=1e-9)
    assert np.array_equal(a.position_m, b.position_m)
    assert (a.facing_rad is None) == (b.facing_rad is None)
    assert a.facing_rad is None or np.array_equal(a.facing_rad, b.facing_rad)
    assert (a.frame, a.source, a.session) == (b.frame, b.source, b.session)


@st.composite
def walks(draw) -> RecordedWalk:
    n = draw(st.integers(2, 12))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    time = np.cumsum(rng.uniform(0.1, 2.0, n))
    session = draw(st.sampled_from([(), ("17",), ("first try",), ("007",), ("17", "x")]))
    arkit = Odometry(
        time, rng.normal(size=(n, 2)), draw(st.sampled_from([None, time])), session=session
    )
    ronin = Odometry(time, rng.normal(size=(n, 2)), frame="own", source="inertial", session=session)
    has = draw(st.sampled_from([(1, 1), (1, 0), (0, 1)]))
    reference = rng.normal(size=(n, 2))
    reference[:7] = np.nan
    reference[rng.random(n) < 0.2] = np.nan
    truth = None
    if draw(st.booleans()):
        reference = np.ones((n, 2))
        truth = Truth(time, reference, rng.normal(size=n), ("1",) * n)
    return RecordedWalk(
        arkit=arkit if has[0] else None,
        ronin=ronin if has[1] else None,
        reference_m=reference,
        start_m=draw(st.sampled_from([None, (1.0, 2.0)])),
        session=session,
        building_id=draw(st.sampled_from([None, "E2"])),
        truth=truth,
    )


@settings(derandomize=True, deadline=None, max_examples=60)
@given(walks())
def test_round_trip(tmp_path_factory, walk):
    path = tmp_path_factory.mktemp("walk") / "a.json"
    write_tracking(walk, path)
    again = read_tracking(path)
    same_odometry(again.arkit, walk.arkit)
    same_odometry(again.ronin, walk.ronin)
    assert np.array_equal(again.reference_m, walk.reference_m, equal_nan=True)
    assert (again.start_m is None) == (walk.start_m is None)
    assert again.start_m is None or again.start_m.tolist() == walk.start_m.tolist()
    assert (again.session, again.building_id) == (walk.session, walk.building_id)
    assert (again.truth is None) == (walk.truth is None)
    if walk.truth is not None:
        assert np.array_equal(again.truth.heading_rad, walk.truth.heading_rad)
    text = path.read_text()
    assert "NaN" not in text
    assert "Infinity" not in text


def test_recognizes(put, tmp_path, walk_content):
    path = put("w/a.json", walk_content)
    assert FORMAT.recognizes(path)
    assert FORMAT.recognizes(path.parent)
    assert not FORMAT.recognizes(put("b.json", "[]"))
    assert not FORMAT.recognizes(put("c.json", '{"a": 1}'))
    assert not FORMAT.recognizes(tmp_path / "none")
