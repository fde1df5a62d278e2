import numpy as np
import pytest

from palms.evaluation.simulation import (
    InertialNoise,
    TrueWalk,
    VioNoise,
    inertial_odometry,
    vio_odometry,
)

TRIALS = 1500
RATES = (1.0, 2.0, 20.0)  # samples a second


def straight(rate_hz, length_m=72.0, speed=1.2):
    """Walk along x for a minute."""
    time = np.arange(1, round(length_m / speed * rate_hz) + 1) / rate_hz
    position = np.column_stack([speed * time, np.zeros(len(time))])
    return TrueWalk(time, position, np.zeros(len(time)), np.zeros(2))


def ends(make, truth, noise, trials=TRIALS):
    rng = np.random.default_rng(0)
    return np.array([make(truth, noise, rng).position_m[-1] for _ in range(trials)])


def vio(truth, noise, rng):
    return vio_odometry(truth, 0.0, noise, rng)


@pytest.mark.parametrize("rate_hz", RATES)
def test_vio_heading_drifts_one_degree_a_minute(rate_hz):
    noise = VioNoise(scale_sd=0.0, white_m_per_sqrt_m=0.0)
    rng = np.random.default_rng(0)
    truth = straight(rate_hz)
    drawn = [vio(truth, noise, rng).displacements_m[-1] for _ in range(TRIALS)]
    heading = np.degrees([np.arctan2(y, x) for x, y in drawn])
    assert heading.std() == pytest.approx(1.0, rel=0.07)


@pytest.mark.parametrize("rate_hz", RATES)
def test_vio_ends_as_far_off_at_any_sampling_rate(rate_hz):
    end = ends(vio, straight(rate_hz), VioNoise())
    # along: 2 % of 72 m and white noise; across: the drift's integral and white noise
    assert end[:, 0].std() == pytest.approx(np.hypot(0.02 * 72, 0.02 * 72**0.5), rel=0.07)
    across = np.radians(1.0) * 72 / 3**0.5
    assert end[:, 1].std() == pytest.approx(np.hypot(across, 0.02 * 72**0.5), rel=0.07)
    assert end.mean(axis=0) == pytest.approx([72.0, 0.0], abs=0.15)


@pytest.mark.parametrize("rate_hz", RATES)
def test_inertial_ends_as_far_off_at_any_sampling_rate(rate_hz):
    truth = straight(rate_hz)
    noise = InertialNoise()
    length = np.linalg.norm(ends(inertial_odometry, truth, noise), axis=1)
    legs = 72 / 15
    expected = 72 * np.hypot(0.09, 0.10 / legs**0.5)
    assert length.std() == pytest.approx(expected, rel=0.1)
    quiet = InertialNoise(0.0, noise.sideways_m_per_sqrt_m, 1.0, 0.0, 0.0)
    spread = np.linalg.norm(ends(inertial_odometry, truth, quiet, 300), axis=1)
    assert spread == pytest.approx(np.full(300, 72.0), rel=0.01)


def test_inertial_frames_are_turned_any_way():
    end = ends(inertial_odometry, straight(1.0), InertialNoise(), 4000)
    angles = np.arctan2(end[:, 1], end[:, 0])
    assert np.abs(np.exp(1j * angles).mean()) < 3 / 4000**0.5


def test_without_noise_odometry_is_the_walk_seen_from_its_start():
    truth = straight(2.0)
    odometry = vio_odometry(truth, np.pi / 2, VioNoise(0, 0, 0), np.random.default_rng(0))
    np.testing.assert_allclose(odometry.position_m, truth.position_m[:, ::-1] * [1, -1], atol=1e-9)


def test_standing_still_makes_no_noise():
    truth = TrueWalk([12.0, 12.5], [[0.0, 0.0], [0.6, 0.0]], [0.0, 0.0], [0.0, 0.0])
    for make in (vio, inertial_odometry):
        noise = VioNoise() if make is vio else InertialNoise()
        assert make(truth, noise, np.random.default_rng(0)).position_m[0].tolist() == [0, 0]
