"""Grid: metres to cells and back; the only place that knows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from palms.errors import InputError
from palms.geometry import FloatArray, as_readonly, check_finite

__all__ = ["Grid"]


@dataclass(frozen=True, slots=True)
class Grid:
    """A raster of square cells in a frame of metres.

    Rows grow with y, columns with x. The position of a cell is its centre.

    Parameters
    ----------
    origin_m : array_like (2,)
        The lower left corner of cell (0, 0).
    cell_size_m : float
        Side of a cell, above 0.
    shape : tuple of int
        (rows, columns), each at least 1.

    Examples
    --------
    >>> grid = Grid((0.0, 0.0), 0.5, (4, 6))
    >>> grid.position_of((0, 1)).tolist()
    [0.75, 0.25]
    >>> grid.cell_of([0.75, 0.25]).tolist()
    [0, 1]
    """

    origin_m: FloatArray
    cell_size_m: float
    shape: tuple[int, int]

    def __post_init__(self) -> None:
        object.__setattr__(self, "origin_m", check_finite(self.origin_m, "grid origin", (2,)))
        if not (np.isfinite(self.cell_size_m) and self.cell_size_m > 0):
            raise InputError("grid", expected="a cell size above 0 m", got=str(self.cell_size_m))
        if min(self.shape) < 1:
            raise InputError("grid", expected="at least one row and column", got=str(self.shape))

    @classmethod
    def covering(cls, lower_m: npt.ArrayLike, upper_m: npt.ArrayLike, cell_size_m: float) -> Grid:
        """Return the smallest grid that covers a box, its corners on multiples of the cell size.

        Examples
        --------
        >>> Grid.covering((0.05, 0.0), (1.0, 0.3), 0.1).shape
        (3, 10)
        """
        low = np.floor(np.asarray(lower_m, dtype=np.float64) / cell_size_m + 1e-9)
        high = np.ceil(np.asarray(upper_m, dtype=np.float64) / cell_size_m - 1e-9)
        columns, rows = np.maximum(high - low, 1).astype(int)
        return cls(as_readonly(low * cell_size_m), cell_size_m, (int(rows), int(columns)))

    @property
    def size(self) -> int:
        """Number of cells."""
        return self.shape[0] * self.shape[1]

    def position_of(self, cells: npt.ArrayLike) -> FloatArray:
        """Centres (..., 2) in metres of cells (..., 2) given as (row, column)."""
        cells = np.asarray(cells)
        return self.origin_m + (cells[..., ::-1] + 0.5) * self.cell_size_m

    def cell_of(self, points_m: npt.ArrayLike) -> npt.NDArray[np.int64]:
        """Cells (..., 2) as (row, column) that hold points (..., 2); may lie outside."""
        rel = (np.asarray(points_m, dtype=np.float64) - self.origin_m) / self.cell_size_m
        return np.floor(rel).astype(np.int64)[..., ::-1]

    def contains(self, points_m: npt.ArrayLike) -> npt.NDArray[np.bool_]:
        """Whether points (..., 2) lie on the grid."""
        cells = self.cell_of(points_m)
        return np.asarray(((cells >= 0) & (cells < np.array(self.shape))).all(axis=-1))

    def extent_m(self) -> tuple[float, float, float, float]:
        """(left, right, bottom, top) in metres, as pictures want it."""
        x, y = (float(v) for v in self.origin_m)
        rows, columns = self.shape
        return x, x + columns * self.cell_size_m, y, y + rows * self.cell_size_m
