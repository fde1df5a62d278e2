import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palms.errors import InputError
from palms.grid import Grid

sizes = st.integers(1, 40)
metres = st.floats(-1000, 1000)


@settings(derandomize=True, deadline=None)
@given(metres, metres, st.floats(0.05, 2), sizes, sizes)
def test_a_cells_centre_lies_in_the_cell(x, y, cell, rows, columns):
    grid = Grid((x, y), cell, (rows, columns))
    cells = np.argwhere(np.ones(grid.shape, bool))
    centres = grid.position_of(cells)
    assert (grid.cell_of(centres) == cells).all()
    assert grid.contains(centres).all()
    assert not grid.contains([x - 0.01, y]).any()


def test_rows_grow_with_y_and_columns_with_x():
    grid = Grid((10.0, 20.0), 0.5, (4, 6))
    assert grid.position_of((0, 0)).tolist() == [10.25, 20.25]
    assert grid.position_of((3, 5)).tolist() == [12.75, 21.75]
    assert grid.extent_m() == (10.0, 13.0, 20.0, 22.0)


@settings(derandomize=True, deadline=None)
@given(metres, metres, st.floats(0, 50), st.floats(0, 50), st.sampled_from([0.1, 0.25, 0.5]))
def test_a_covering_grid_covers_its_box_with_no_row_too_many(x, y, width, height, cell):
    grid = Grid.covering((x, y), (x + width, y + height), cell)
    left, right, bottom, top = grid.extent_m()
    assert left <= x + 1e-6
    assert bottom <= y + 1e-6
    assert right >= x + width - 1e-6
    assert top >= y + height - 1e-6
    assert grid.shape[1] <= width / cell + 2
    assert grid.shape[0] <= height / cell + 2


@pytest.mark.parametrize(("cell", "shape"), [(0.0, (1, 1)), (np.nan, (1, 1)), (1.0, (0, 3))])
def test_impossible_grids_are_refused(cell, shape):
    with pytest.raises(InputError, match="grid: expected"):
        Grid((0, 0), cell, shape)
