import numpy as np
import pytest
import shapely

from palms.errors import InputError
from palms.evaluation.simulation import RouteSettings, plan_route, walk
from palms.floorplan import SegmentClass

START = np.array([68.2, 39.2])


@pytest.fixture(scope="module", params=range(4))
def truth(free, request):
    rng = np.random.default_rng(request.param)
    route = plan_route(free, START, 147.0, RouteSettings(), rng)
    return walk(route, 147.0, RouteSettings(), rng, start_s=12.0)


def test_the_walk_is_as_long_as_asked(truth):
    assert truth.length_m == pytest.approx(147.0, abs=1.0)
    np.testing.assert_allclose(truth.start_m, START, atol=0.2)


def test_nobody_walks_through_walls_or_scrapes_them(truth, world, plan):
    path = shapely.LineString(np.vstack([truth.start_m, truth.position_m]))
    blocking = shapely.MultiLineString(list(world.blocking_m))
    assert not path.crosses(blocking)
    assert path.distance(blocking) > 0.2
    missing_too = shapely.MultiLineString(list(plan.of_class(SegmentClass.WALL)))
    crossings = shapely.get_parts(shapely.intersection(path, missing_too))
    assert len(crossings) <= 2  # a partition that the world has not


def test_steps_are_human(truth):
    steps = np.linalg.norm(truth.moves_m, axis=1)
    waited = np.diff(truth.time_s, prepend=12.0)
    assert np.median(steps) == pytest.approx(0.65, abs=0.03)
    assert steps.max() < 0.9
    assert steps.sum() / waited.sum() == pytest.approx(1.2, abs=0.05)
    turns = np.abs(np.diff(np.unwrap(truth.heading_rad)))
    assert np.median(turns) < 0.2
    assert np.ptp(np.unwrap(truth.heading_rad)) > np.pi / 3


def test_headings_are_those_of_the_steps(truth):
    unit = np.column_stack([np.cos(truth.heading_rad), np.sin(truth.heading_rad)])
    steps = np.linalg.norm(truth.moves_m, axis=1)
    np.testing.assert_allclose(truth.moves_m, steps[:, None] * unit, atol=1e-9)


def test_rooms_are_visited_when_asked_for(free):
    settings = RouteSettings(room_visit_share=1.0)
    route = plan_route(free, START, 147.0, settings, np.random.default_rng(0))
    cells = tuple(free.grid.cell_of(route).T)
    assert not free.is_corridor[cells].all()


def test_same_seed_same_route(free):
    routes = [
        plan_route(free, START, 60.0, RouteSettings(), np.random.default_rng(5)) for _ in range(2)
    ]
    np.testing.assert_array_equal(*routes)


@pytest.mark.parametrize("start", [[-50.0, 0.0], [67.0, 40.0]], ids=["outdoors", "in a wall"])
def test_nobody_starts_where_nobody_can_stand(free, start):
    with pytest.raises(InputError, match="start of the walk"):
        plan_route(free, start, 20.0, RouteSettings(), np.random.default_rng(0))
