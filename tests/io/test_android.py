from __future__ import annotations

import gzip
import warnings
from pathlib import Path

import numpy as np
import pytest

from palms.errors import FormatError, InputError, PalmsWarning
from palms.io import read_walk
from palms.io.android import read_android
from palms.io.reckoned import report_damage
from tests.inertial.walker import Phone, corners, sense

FILE = Path(__file__).parent / "data" / "walks" / "android.txt"
T0 = 1_700_000_000_000


def rows(kind: str, time_s, values) -> list[str]:
    return [
        f"{T0 + round(1000 * t)}\tTYPE_{kind}\t" + "\t".join(f"{v:.5f}" for v in each) + "\t3"
        for t, each in zip(time_s.tolist(), values.tolist(), strict=True)
    ]


@pytest.fixture(scope="module")
def log():
    return sense(*corners(100), Phone(rate_hz=50.0), np.random.default_rng(2)).log


@pytest.fixture
def usual(log):
    return [*rows("ACCELEROMETER", log.time_s, log.acceleration_m_s2),
            *rows("GYROSCOPE", log.time_s, log.rate_rad_s)]  # fmt: skip


def test_rows_may_come_in_any_order(put, usual):
    ordered = read_android(put("a.txt", "\n".join(usual))).odometry("ronin")
    shuffled = [usual[k] for k in np.random.default_rng(1).permutation(len(usual))]
    mixed = read_android(put("b.txt", "\n".join(shuffled))).odometry("ronin")
    np.testing.assert_allclose(mixed.position_m, ordered.position_m)
    assert not read_android(put("a.txt", "\n".join(usual))).has_reference.any()


def test_other_sensors_serve_where_the_usual_are_missing(put, log, usual):
    walk = read_android(put("a.txt", "\n".join(usual))).odometry("ronin")
    still = np.tile([0.0, 0.0, 0.0], (len(log.time_s), 1))
    uncalibrated = [
        *rows("ACCELEROMETER_UNCALIBRATED", log.time_s, np.hstack([log.acceleration_m_s2, still])),
        *rows("GYROSCOPE_UNCALIBRATED", log.time_s, np.hstack([log.rate_rad_s, still])),
    ]
    linear = [
        *rows("LINEAR_ACCELERATION", log.time_s, log.acceleration_m_s2 - [0, 5, 8]),
        *rows("GRAVITY", log.time_s, still + [0, 5, 8]),
        *rows(
            "GAME_ROTATION_VECTOR", log.time_s, log.attitude[:, :3] * np.sign(log.attitude[:, 3:])
        ),
    ]
    for lines in (uncalibrated, linear):
        other = read_android(put("b.txt", "\n".join(lines))).odometry("ronin")
        assert len(other) == pytest.approx(len(walk), abs=1)
        assert other.walked_m[-1] == pytest.approx(walk.walked_m[-1], rel=0.02)


def test_damaged_lines_are_counted_and_left_out(put, usual):
    whole = read_android(put("a.txt", "\n".join(usual))).odometry("ronin")
    damaged = [*usual]
    damaged[50] = damaged[50].replace("\t", " ")  # no row at all
    damaged[60] = damaged[60][:45]
    damaged[70] = damaged[70].replace(".", ".x")
    damaged[80] = f"{T0 + 1600}\tTYPE_ACCELEROMETER\t9e9\t0\t0"
    damaged[90] = f"{T0 + 1800}\tTYPE_ACCELEROMETER\tnan\t0\t0"
    damaged[100] = f"{T0 * 9}\tTYPE_ACCELEROMETER\t0\t9\t0\t3"  # in another century
    damaged[110:112] = [damaged[110] + damaged[111]]
    with pytest.warns(PalmsWarning, match=r"a.txt: 4 of \d+ rows of sensors cannot be read"):
        walk = read_android(put("a.txt", "\r\n".join(damaged))).odometry("ronin")
    assert np.abs(walk.position_m[-1] - whole.position_m[-1]).max() < 0.3


def test_more_damage_than_rows_is_refused(put, usual, says):
    broken = [line[:40] for line in usual[::2]] + usual[::4]
    with pytest.raises(FormatError) as caught:
        read_android(put("a.txt", "\n".join(broken)))
    says(caught.value, "a.txt", "cannot be read")
    report_damage(0, 0, "a.txt")


@pytest.mark.parametrize(
    ("kinds", "part"),
    [
        ({"GYROSCOPE"}, "accelerometer"),
        ({"ACCELEROMETER"}, "gyroscope"),
        ({"MAGNETIC_FIELD"}, "an Android sensor log"),
    ],
)
def test_a_missing_sensor_is_named(put, log, says, kinds, part):
    lines = [line for kind in kinds for line in rows(kind, log.time_s, log.acceleration_m_s2)]
    with pytest.raises(InputError) as caught:
        read_android(put("a.txt", "\n".join(lines)))
    says(caught.value, "a.txt", part)


def test_options(put, usual, says):
    path = put("a.txt", "\n".join(usual))
    short = read_android(path, length="constant", step_m="0.5").odometry("ronin")
    np.testing.assert_allclose(np.diff(short.walked_m), 0.5)
    assert read_android(path, leg_m=1.0).ronin.walked_m[-1] > read_android(path).ronin.walked_m[-1]
    for wrong in ({"length": "far"}, {"heading": "up"}, {"step_m": 9}, {"leg_m": "long"}):
        with pytest.raises(InputError) as caught:
            read_android(path, **wrong)
        says(caught.value, f"option {next(iter(wrong))}")
    with pytest.raises(InputError, match="there is no rotation vector"):
        read_android(path, heading="attitude")


def test_waypoints_belong_to_the_nearest_step(put, usual):
    marks = [f"{T0 + round(1000 * t)}\tTYPE_WAYPOINT\t{x}\t{y}"
             for t, x, y in ((0, 5.5, 7.25), (20.3, 9.0, 7.25), (500, 1.0, 1.0))]  # fmt: skip
    walk = read_android(put("a.txt", "\n".join([*usual, *marks])))
    assert walk.start_m.tolist() == [5.5, 7.25]
    assert walk.ahead_m.tolist() == [9.0, 7.25]
    (known,) = np.nonzero(walk.has_reference)
    assert walk.reference_m[known].tolist() == [[9.0, 7.25]]
    assert abs(walk.time_s[known[0]] - 20.3) < 0.5


def test_a_packed_log_is_the_same(tmp_path):
    packed = tmp_path / "log.txt.gz"
    packed.write_bytes(gzip.compress(FILE.read_bytes()))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PalmsWarning)
        one, other = read_walk(packed), read_walk(FILE)
    np.testing.assert_array_equal(one.ronin.position_m, other.ronin.position_m)


def test_pauses_and_slow_sensors_are_said(put, usual, log):
    paused = [line for line in usual if not 10_000 < int(line[:13]) - T0 < 14_000]
    with pytest.warns(PalmsWarning, match=r"no readings of \w+ for 4\.0 s from 10 s on"):
        read_android(put("a.txt", "\n".join(paused)))
    half = len(log.time_s)
    slow = [*usual[:half:4], *usual[half::4]]
    with pytest.warns(PalmsWarning, match=r"only 1[23] readings of \w+ a second"):
        read_android(put("a.txt", "\n".join(slow)))


def test_a_bomb_of_gzip_is_refused(tmp_path, monkeypatch, says):
    monkeypatch.setattr("palms.io.packed.MAX_BYTES", 100_000)
    path = tmp_path / "log.txt.gz"
    path.write_bytes(gzip.compress(b"1700000000000\tTYPE_ACCELEROMETER\t0\t0\t9.8\t3\n" * 10_000))
    with pytest.raises(InputError) as caught:
        read_walk(path)
    says(caught.value, "log.txt.gz", "more")
    path.write_bytes(gzip.compress(b"1700000000000\tTYPE_WIFI\t" + b"0" * 300_000))
    with pytest.raises(InputError) as caught:
        read_walk(path)
    says(caught.value, "log.txt.gz", "more")
