import numpy as np
import pytest

from palms import Scan
from palms.plot import scan_figure
from palms.plot.scans import coverage_outline

WALLS = [[[2, -2], [2, 2]], [[-2, 2], [2, 2]]]


def artists(figure, gid):
    return [artist for artist in figure.axes[0].get_children() if artist.get_gid() == gid]


def words(figure):
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def test_without_coverage_the_triangles_are_drawn():
    figure = scan_figure(Scan(WALLS))
    assert figure.axes[0].get_title(loc="left") == "2 walls, 8.0 m"
    assert len(artists(figure, "empty")) == 2
    assert "certainly empty space" in words(figure)
    assert artists(figure, "scan")
    assert artists(figure, "scale-bar")


def test_with_coverage_that_is_drawn():
    figure = scan_figure(Scan(WALLS, coverage_m=np.full(360, 1.5)), points_m=np.zeros((9, 2)))
    (empty,) = artists(figure, "empty")
    np.testing.assert_allclose(np.linalg.norm(empty.get_xy(), axis=1), 1.5)
    assert words(figure) == ["wall seen", "seen to be empty", "points", "observation point"]


@pytest.mark.parametrize(
    ("coverage", "count", "area"),
    [
        (np.full(360, 2.0), 1, 4 * np.pi),
        (np.where(np.arange(360) < 90, 2.0, np.nan), 1, np.pi),
        (np.where((np.arange(360) < 30) | (np.arange(360) >= 330), 2.0, np.nan), 1, 4 * np.pi / 6),
        (np.where(np.arange(360) % 180 < 90, 2.0, np.nan), 2, np.pi),
        (np.full(360, np.nan), 0, 0),
    ],
)
def test_outlines_of_coverage(coverage, count, area):
    import shapely

    outlines = coverage_outline(Scan(WALLS, (1, 1), coverage))
    assert len(outlines) == count
    for outline in outlines:
        assert shapely.Polygon(outline).area == pytest.approx(area, rel=1e-3)
