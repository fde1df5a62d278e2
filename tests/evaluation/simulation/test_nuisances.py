import numpy as np
import pytest

from palms.errors import SettingsError
from palms.evaluation.simulation import (
    InertialNoise,
    NuisanceRanges,
    Nuisances,
    PlanNoise,
    ScannerNoise,
    VioNoise,
    WorldNoise,
    draw_nuisances,
)

DEFAULTS = {"world": WorldNoise(), "plan": PlanNoise(), "scanner": ScannerNoise()}
DEFAULTS |= {"vio": VioNoise(), "inertial": InertialNoise()}


@pytest.fixture(scope="module")
def drawn():
    rng = np.random.default_rng(0)
    return [draw_nuisances(rng) for _ in range(400)]


def test_ranges_and_nuisances_have_the_same_names():
    assert NuisanceRanges.names() == tuple(Nuisances.__slots__)


@pytest.mark.parametrize("name", NuisanceRanges.names())
def test_each_is_drawn_over_its_whole_range(drawn, name):
    low, high = getattr(NuisanceRanges(), name)
    values = np.array([getattr(each, name) for each in drawn])
    assert values.min() >= low * (1 - 1e-9)
    assert values.max() <= high * (1 + 1e-9)
    assert np.ptp(values) >= 0.9 * (high - low)


@pytest.mark.parametrize("group", DEFAULTS)
def test_usual_values_lie_within_what_is_drawn(drawn, group):
    usual = DEFAULTS[group]
    settings = [getattr(each, group) for each in drawn]
    for name in usual.__slots__:
        values = [getattr(each, name) for each in settings]
        assert min(values) <= getattr(usual, name) <= max(values), name


def test_doubling_one_leaves_the_others(drawn):
    for name in NuisanceRanges.names():
        other = draw_nuisances(np.random.default_rng(0), NuisanceRanges().double(name)).to_json()
        plain = drawn[0].to_json()
        assert {key for key in plain if plain[key] != other[key]} == {name}
        assert other[name] / plain[name] == pytest.approx(2.0) or other[name] <= 1.0
    assert NuisanceRanges().double("door_shut_share").door_shut_share == (0.7, 1.0)


def test_what_makes_no_sense_is_refused():
    with pytest.raises(SettingsError, match="expected one of thickness_m"):
        NuisanceRanges().double("luck")
    with pytest.raises(SettingsError, match="low <= high"):
        NuisanceRanges(thickness_m=(0.2, 0.1))
