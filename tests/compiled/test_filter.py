import numpy as np
import pytest
import shapely
from scipy import stats

from palms._compiled import filter as loops
from palms._compiled import weights as by_weight
from palms.floorplan import FloorPlan
from palms.randomness import as_key
from palms.raster import rasterize
from tests.compiled import twins
from tests.worlds import two_rooms

KEY = np.uint64(0x1234567890ABCDEF)
ZERO = np.zeros((1, 2))


def normals(n, k=1, key=KEY):
    out = np.empty((n, k))
    loops.normals(key, k, out)
    return out


def test_random_numbers_equal_their_twin_bit_for_bit():
    fast = normals(3000, 3)
    uniform = np.empty((50, 4))
    loops.uniforms(KEY, 4, uniform)
    for i in range(0, 3000, 7):
        stream = twins.Stream(int(KEY), i)
        assert [stream.normal() for _ in range(3)] == list(fast[i])
    for i in range(50):
        stream = twins.Stream(int(KEY), i)
        assert [stream.uniform() for _ in range(4)] == list(uniform[i])


def test_normals_are_normal_and_independent():
    z = normals(400_000, 2)
    assert stats.kstest(z[:, 0], "norm").pvalue > 1e-3
    assert stats.kurtosis(z[:, 1]) == pytest.approx(0, abs=0.03)
    assert np.abs(np.corrcoef(z.T)[0, 1]) < 0.006
    assert np.abs(np.corrcoef(z[1:, 0], z[:-1, 0])[0, 1]) < 0.006  # neighbours
    other = normals(400_000, 1, as_key(1).word)
    assert np.abs(np.corrcoef(z[:, 0], other[:, 0])[0, 1]) < 0.006  # keys
    assert (np.abs(z) > 3.5).mean() == pytest.approx(2 * stats.norm.sf(3.5), rel=0.25)  # tail


def test_keys_do_not_repeat():
    seen = {as_key(seed).child(step, 2).value for seed in range(100) for step in range(300)}
    assert len(seen) == 30_000


@pytest.mark.parametrize("reach", [0.05, 0.7, 5.0, 40.0])
def test_walls_block_exactly_the_moves_that_touch_them(reach):
    rng = np.random.default_rng(int(reach * 100))
    raster = rasterize(two_rooms())
    lines = shapely.linestrings(raster.plan.blocking_m)
    start = rng.uniform([0.1, 0.1], [19.9, 11.9], (1500, 2))
    end = np.clip(start + rng.normal(0, reach, (1500, 2)), [-0.9, -0.9], [20.9, 12.9])
    assert (raster.blocked(start, end) == twins.blocked(lines, start, end)).all()


def test_no_move_slips_through_a_corner():
    corner = FloorPlan([[[0, 0], [5, 5]], [[5, 5], [10, 0]], [[5, 5], [5, 9]]])
    raster = rasterize(corner)
    angle = np.linspace(0.05, np.pi / 2 - 0.05, 500)
    offset = 3 * np.stack([np.sin(angle) * 0, np.cos(angle)], axis=1) + [0, 0.1]
    start, end = np.array([5, 5]) - offset, np.array([5, 5]) + offset
    assert raster.blocked(start, end).all()  # all run exactly through the corner
    nudge = np.nextafter(5.0, [4, 6])
    for x in nudge:
        assert raster.blocked([[x, 3.0]], [[x, 7.0]]).all()


def test_standing_still_is_never_blocked_and_leaving_the_plan_is():
    raster = rasterize(two_rooms())
    assert not raster.blocked([[5.0, 1.0]], [[5.0, 1.0]])[0]
    assert raster.blocked([[0.0, -0.5]], [[0.0, -3.0]])[0]


def test_doors_and_openings_let_people_through_and_glass_does_not():
    wall = [[0, 0], [0, 4]]
    start, end = [[-0.5, 2.0]], [[0.5, 2.0]]
    frame = [[-2, -1], [-2, 5]]
    for kind, stops in ((0, True), (1, False), (2, False), (3, True)):
        raster = rasterize(FloorPlan([wall, frame], classes=[kind, 0]))
        assert raster.blocked(start, end)[0] == stops


def test_moves_equal_their_twin():
    rng = np.random.default_rng(0)
    raster = rasterize(two_rooms())
    position = rng.uniform([1, 1], [19, 11], (300, 2))
    drift, scale = rng.uniform(-3, 3, 300), rng.normal(1, 0.02, 300)
    step, noise = (0.5, -0.3), (0.05, 0.02, 0.007)
    new_position, new_drift = np.empty((300, 2)), np.empty(300)
    hit = np.empty(300, np.bool_)
    n = loops.move(
        position, drift, scale, step, noise, KEY, raster.walls, new_position, new_drift, hit
    )
    expected, turned = twins.move(position, drift, scale, step, noise, int(KEY))
    assert new_position == pytest.approx(expected, abs=1e-12)
    assert new_drift == pytest.approx(turned, abs=1e-12)
    lines = shapely.linestrings(raster.plan.blocking_m)
    assert (hit == twins.blocked(lines, position, new_position)).all()
    assert n == hit.sum() > 0


@pytest.mark.parametrize("n", [1, loops.CHUNK - 1, loops.CHUNK, loops.CHUNK + 1, 5000])
def test_a_move_draws_the_numbers_of_each_particle_whatever_their_number(n):
    walls = rasterize(two_rooms()).walls
    position, drift, hit = np.empty((n, 2)), np.empty(n), np.empty(n, np.bool_)
    start = np.full((n, 2), 5.0)
    for k, noise in enumerate(((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))):
        loops.move(
            start, np.zeros(n), np.ones(n), (0.0, 0.0), noise, KEY, walls, position, drift, hit
        )
        drawn = (position[:, 0] - 5.0, position[:, 1] - 5.0, drift)[k]
        assert drawn == pytest.approx(normals(n, 3)[:, k], abs=1e-14)
    assert (drift == normals(n, 3)[:, 2]).all()  # to the bit, the long way round, too


def test_copies_come_from_survivors_and_stay_on_their_side_of_the_wall():
    rng = np.random.default_rng(3)
    raster = rasterize(two_rooms())
    position = np.column_stack([rng.uniform(1, 7, 400), rng.uniform(4.7, 4.99, 400)])
    drift, scale = rng.uniform(-1, 1, 400), rng.uniform(0.9, 1.1, 400)
    label = np.arange(400, dtype=np.int32)
    hit = rng.random(400) < 0.7
    before = position.copy(), drift.copy()
    loops.replace_hits(position, drift, scale, label, hit, np.array([0.1, 0.0]), KEY, raster.walls)
    assert (position[~hit] == before[0][~hit]).all()
    parent = label[hit]
    assert not hit[parent].any()
    assert len(np.unique(parent)) > 50  # random survivors, not one
    assert (drift[hit] == before[1][parent]).all()
    moved = position[hit] - before[0][parent]
    assert 0.05 < moved.std() < 0.1
    lines = shapely.linestrings(raster.plan.blocking_m)
    assert not twins.blocked(lines, before[0][parent], position[hit]).any()


def test_without_survivors_nothing_is_replaced():
    raster = rasterize(two_rooms())
    position, drift, scale = np.ones((5, 2)), np.zeros(5), np.ones(5)
    label = np.arange(5, dtype=np.int32)
    loops.replace_hits(
        position, drift, scale, label, np.ones(5, np.bool_), np.ones(2), KEY, raster.walls
    )
    assert (position == 1).all()
    assert (label == np.arange(5)).all()


@pytest.mark.parametrize("seed", range(5))
def test_systematic_resampling_equals_its_twin(seed):
    rng = np.random.default_rng(seed)
    weights = rng.random(200) ** 4
    weights[rng.random(200) < 0.3] = 0
    u = rng.random()
    out = np.empty(333, np.int64)
    by_weight.systematic(weights, 333, u, out)
    assert (out == twins.systematic(weights, 333, u)).all()
    share = 333 * weights / weights.sum()
    assert (np.abs(np.bincount(out, minlength=200) - share) < 1).all()


def drifts(n=4000):
    """Ordinary ones, many turns, and the neighbourhood of quarter turns."""
    rng = np.random.default_rng(0)
    quarters = np.arange(-40, 41) * np.pi / 2
    near = np.concatenate([quarters, np.nextafter(quarters, 9e9), quarters + 1e-9])
    return np.concatenate([rng.uniform(-7, 7, n), rng.uniform(-1e5, 1e5, n), near])


def test_sines_and_cosines_are_those_of_the_library():
    drift = drifts()
    n = len(drift)
    sums = np.empty((n, 5))
    for i in range(n):
        one = slice(i, i + 1)
        loops.gathered(ZERO, drift[one], np.ones(1), np.zeros(1, np.int8), sums[one])
    assert np.abs(sums[:, 3] - np.cos(drift)).max() < 3e-16
    assert np.abs(sums[:, 4] - np.sin(drift)).max() < 3e-16


def test_sums_over_places_equal_numpys():
    rng = np.random.default_rng(3)
    n = 5000
    position, drift, weight = rng.normal(size=(n, 2)), rng.uniform(-9, 9, n), rng.random(n)
    place = rng.integers(-1, 3, n).astype(np.int8)
    sums = np.empty((4, 5))
    loops.gathered(position, drift, weight, place, sums)
    for k in range(4):
        w, p, d = (a[place == k] for a in (weight, position, drift))
        here = [
            w.sum(),
            *(w[:, None] * p).sum(axis=0),
            (w * np.cos(d)).sum(),
            (w * np.sin(d)).sum(),
        ]
        assert sums[k] == pytest.approx(here, rel=1e-12, abs=1e-12)
    assert (sums[3] == 0).all()


def test_weights_and_their_moments_equal_numpys():
    rng = np.random.default_rng(4)
    weight, factor, out = rng.random(3000), rng.random(3000), np.empty(3000)
    assert by_weight.weighed(weight, factor, out) == pytest.approx(float((weight * factor).sum()))
    assert (out == weight * factor).all()
    assert by_weight.moments(out) == pytest.approx((out.sum(), (out**2).sum()))


def test_sums_of_labels_are_numpys():
    rng = np.random.default_rng(6)
    label, weight = rng.integers(0, 5, 3000).astype(np.int32), rng.random(3000)
    for labels in (label, np.sort(label), label[:1]):
        sums = by_weight.by_label(labels, weight[: len(labels)])
        assert (sums == np.bincount(labels, weight[: len(labels)])).all()
