"""Dead reckoning of a log that still grows tells the walk that the whole log tells."""

import numpy as np
import pytest

from palms.inertial import dead_reckon
from palms.server.messages import Inertial, Reading
from palms.server.reckoner import WINDOW_S, Reckoner, reckoned
from tests.inertial.walker import Phone, sense

SIDES = [(40, 0.0), (30, 1.3), (50, -0.6), (40, 2.4), (30, 0.9)]


def walked(seed=3, **phone):
    """A log of a walk along straight sides, longer than two windows."""
    turns = np.concatenate([np.full(n, heading) for n, heading in SIDES])
    steps = 0.65 * np.column_stack([np.cos(turns), np.sin(turns)])
    places = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    time_s = 3.0 + 0.55 * np.arange(len(places))
    return sense(time_s, places, Phone(**phone), np.random.default_rng(seed))


def readings(log, start=0.0, end=np.inf, base_s=1.7e9):
    kept = [("totalacceleration", log.acceleration_m_s2), ("gyroscope", log.rate_rad_s)]
    now = (log.time_s >= start) & (log.time_s < end)
    return tuple(
        Reading(sensor=name, t_s=base_s + t, values=tuple(row))
        for name, values in kept
        for t, row in zip(log.time_s[now].tolist(), values[now].tolist(), strict=True)
    )


def streamed(log, every_s):
    reckoner, samples = Reckoner(), []
    for seq, start in enumerate(np.arange(0.0, log.time_s[-1], every_s), 1):
        message = Inertial(seq=seq, readings=readings(log, start, start + every_s))
        reckoner, new = reckoned(reckoner, message)
        samples += new
    return reckoner, samples


def off_m(places, truth):
    """Root mean square distance once the first is turned and shifted onto the second."""
    a, b = places - places.mean(axis=0), truth - truth.mean(axis=0)
    turn = np.angle(np.sum((b[:, 0] + 1j * b[:, 1]) * (a[:, 0] - 1j * a[:, 1])))
    c, s = np.cos(turn), np.sin(turn)
    return float(np.sqrt(np.mean(np.sum((a @ np.array([[c, s], [-s, c]]) - b) ** 2, axis=1))))


@pytest.mark.parametrize("every_s", [0.4, 2.5])
def test_a_stream_tells_the_walk_that_the_whole_log_tells(every_s):
    sensed = walked()
    assert sensed.log.duration_s > 2 * WINDOW_S
    _, samples = streamed(sensed.log, every_s)
    whole = dead_reckon(sensed.log)
    places = np.cumsum([sample.displacement_m for sample in samples], axis=0)
    times = np.array([sample.t_s for sample in samples]) - 1.7e9
    assert (np.diff(times) > 0).all()
    assert abs(len(places) - len(whole)) <= 4
    at = np.column_stack(
        [np.interp(times, whole.time_s, whole.position_m[:, axis]) for axis in (0, 1)]
    )
    assert off_m(places, at) < 1.0
    true = np.column_stack([np.interp(times, sensed.step_s, sensed.step_m[:, k]) for k in (0, 1)])
    assert off_m(places, true) < 2.5


def test_memory_does_not_grow_with_the_walk():
    reckoner, _ = streamed(walked().log, 2.0)
    n = max(len(time) for time, _ in reckoner.readings.values())
    assert n <= 100 * (WINDOW_S + 5)
    assert len(reckoner.told) < 120


def test_readings_that_come_twice_change_nothing():
    log = walked().log
    reckoner = Reckoner()
    for seq, start in enumerate(np.arange(0.0, 12.0, 1.0)):
        message = Inertial(seq=seq + 1, readings=readings(log, start, start + 1.0))
        reckoner, once = reckoned(reckoner, message)
        again, twice = reckoned(reckoner, message)
        assert twice == ()
        assert len(again.readings["gyroscope"][0]) == len(reckoner.readings["gyroscope"][0])
    assert reckoner.told
    assert once


def test_readings_from_far_apart_take_no_memory():
    readings_ = [
        Reading(sensor=sensor, t_s=t, values=(0.0, 0.0, 9.8))
        for sensor in ("totalacceleration", "gyroscope")
        for t in (0.0, 1.0, 2e4, 2e4 + 1, 1e9, 1e9 + 0.5, 1e9 + 3.0)
    ]
    reckoner, samples = reckoned(Reckoner(), Inertial(seq=1, readings=tuple(readings_)))
    assert samples == ()
    assert len(reckoner.readings["gyroscope"][0]) == 3


def test_nobody_walks_and_nothing_is_told():
    still = [Reading(sensor="totalacceleration", t_s=0.01 * i, values=(0.0, 0.0, 9.8))
             for i in range(1000)]  # fmt: skip
    turns = [Reading(sensor="gyroscope", t_s=0.01 * i, values=(0.0, 0.0, 0.0)) for i in range(1000)]
    assert reckoned(Reckoner(), Inertial(seq=1, readings=(*still, *turns)))[1] == ()
    assert reckoned(Reckoner(), Inertial(seq=1, readings=tuple(still)))[1] == ()
    assert reckoned(Reckoner(), Inertial(seq=1, readings=(still[0], turns[0])))[1] == ()
