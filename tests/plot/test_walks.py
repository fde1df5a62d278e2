import numpy as np
import pytest

from palms import Odometry
from palms.geometry import rotate
from palms.plot import image_bytes, walk_figure


def artists(axes, gid):
    return [artist for artist in axes.get_children() if artist.get_gid() == gid]


def labels(figure):
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


@pytest.fixture
def walk():
    place = np.column_stack([np.arange(1.0, 21.0), np.sin(np.arange(20.0))])
    return Odometry(np.arange(1.0, 21.0), place, facing_rad=np.linspace(0, 1, 20))


def test_a_walk_by_itself(walk):
    figure = walk_figure(walk, title="w")
    (axes,) = figure.axes
    assert labels(figure) == ["walk", "start", "end", "where the phone looked"]
    (line,) = artists(axes, "walk")
    np.testing.assert_allclose(line.get_xydata()[1:], walk.position_m)
    assert not artists(axes, "reference")
    assert axes.get_title(loc="left").startswith("w: 20 samples")
    assert image_bytes(figure, dpi=40).startswith(b"\x89PNG")


def test_a_walk_is_turned_and_moved_to_its_reference(walk):
    reference = rotate(walk.position_m, 2.0) + [50.0, 30.0]
    reference[3:15] = np.nan
    figure = walk_figure(walk, reference)
    (axes,) = figure.axes
    assert labels(figure)[0] == "walk, turned and moved to fit"
    (line,) = artists(axes, "walk")
    np.testing.assert_allclose(line.get_xydata()[-1], reference[-1], atol=1e-9)
    (looks,) = artists(axes, "looks")
    np.testing.assert_allclose(np.arctan2(looks.V, looks.U), walk.facing_rad + 2.0)


def test_one_reference_point_fits_nothing(walk):
    reference = np.full((20, 2), np.nan)
    reference[4] = [100.0, 100.0]
    (axes,) = walk_figure(walk, reference).axes
    (line,) = artists(axes, "walk")
    np.testing.assert_allclose(line.get_xydata()[1:], walk.position_m)
    assert artists(axes, "reference")


@pytest.mark.parametrize("end", [(0.0, 0.0), (0.0, 30.0), (30.0, 0.0)])
def test_walks_without_width_have_a_map(end):
    figure = walk_figure(Odometry([1.0, 2.0], [[0.0, 0.0], end]))
    assert image_bytes(figure, dpi=40).startswith(b"\x89PNG")
