import numpy as np
import pytest

from palms.evaluation.simulation import (
    TrueWalk,
    VioNoise,
    drift_of,
    resampled,
    vio_odometry,
    with_facing,
    with_jump,
    with_pause,
    with_stops,
)
from palms.geometry import wrap_angle


@pytest.fixture
def truth():
    """Walk 60 m east, then 60 m north."""
    step = np.repeat([[0.6, 0.0], [0.0, 0.6]], 100, axis=0)
    heading = np.repeat([0.0, np.pi / 2], 100)
    time = 12.0 + 0.5 * np.arange(1, 201)
    level = ("1",) * 120 + ("2",) * 80
    return TrueWalk(time, np.cumsum(step, axis=0), heading, np.zeros(2), level=level)


def test_a_pause_moves_only_the_clock(truth):
    paused = with_pause(truth, 99, 10.0)
    assert len(paused.time_s) == 220
    assert (np.diff(paused.time_s) > 0).all()
    assert paused.length_m == pytest.approx(truth.length_m)
    standing = (paused.time_s > truth.time_s[99]) & (paused.time_s <= truth.time_s[99] + 10)
    assert standing.sum() == 20
    np.testing.assert_array_equal(
        paused.position_m[standing], np.broadcast_to(truth.position_m[99], (20, 2))
    )
    assert paused.time_s[-1] == pytest.approx(truth.time_s[-1] + 10)


def test_stops_come_about_every_forty_metres(truth):
    rng = np.random.default_rng(0)
    longer = [with_stops(truth, rng).time_s[-1] - truth.time_s[-1] for _ in range(200)]
    assert np.mean(longer) == pytest.approx(3 * 11.5, rel=0.15)


@pytest.mark.parametrize("rate_hz", [1.0, 2.0, 60.0])
def test_any_rate_is_the_same_walk(truth, rate_hz):
    even = resampled(with_facing(truth, np.random.default_rng(0)), rate_hz, 12.0)
    np.testing.assert_allclose(np.diff(even.time_s), 1 / rate_hz, atol=1e-9)
    assert even.time_s[-1] == pytest.approx(112.0, abs=1 / rate_hz + 1e-6)
    assert even.length_m == pytest.approx(120.0, abs=1.5)
    np.testing.assert_allclose(even.position_m[-1], truth.position_m[-1], atol=1.3 / rate_hz)
    assert set(even.level) == {"1", "2"}
    assert len(even.facing_rad) == len(even.time_s)


def test_the_phone_looks_about_where_one_goes(truth):
    rng = np.random.default_rng(0)
    off = np.array([with_facing(truth, rng).facing_rad - truth.heading_rad for _ in range(100)])
    off = wrap_angle(off)
    assert np.degrees(off[:, 20:80].mean(axis=1).std()) == pytest.approx(6.0, rel=0.25)
    assert np.degrees(np.abs(off[:, :90]).max()) < 40


def test_facing_goes_through_the_odometry_with_its_drift(truth):
    facing = with_facing(truth, np.random.default_rng(0))
    odometry = vio_odometry(facing, 0.7, VioNoise(), np.random.default_rng(1))
    drift = drift_of(odometry, facing)
    assert drift[0] == pytest.approx(0.7, abs=0.02)
    assert np.degrees(np.abs(drift - 0.7).max()) < 6
    without = vio_odometry(truth, 0.7, VioNoise(), np.random.default_rng(1))
    np.testing.assert_array_equal(odometry.position_m, without.position_m)


def test_after_a_jump_all_is_shifted_and_turned(truth):
    facing = with_facing(truth, np.random.default_rng(0))
    plain = vio_odometry(facing, 0.0, VioNoise(0, 0, 0), np.random.default_rng(1))
    jumped = with_jump(plain, 50, (1.0, 2.0), 0.3)
    np.testing.assert_array_equal(jumped.position_m[:50], plain.position_m[:50])
    np.testing.assert_allclose(jumped.position_m[50] - plain.position_m[50], [1.0, 2.0])
    assert jumped.walked_m[-1] - plain.walked_m[-1] == pytest.approx(np.hypot(1.6, 2) - 0.6)
    drift = drift_of(jumped, facing)
    np.testing.assert_allclose(drift[:50], 0.0, atol=1e-9)
    np.testing.assert_allclose(drift[50:], -0.3, atol=1e-9)
