"""The first start says that it compiles; later ones say nothing."""

import numba

from palms.cli._compiling import announcing


def test_compiling_is_said_once_and_finding_compiled_loops_is_not():
    one, other = numba.njit(lambda x: x + 1), numba.njit(lambda x: x + 2)
    said = []
    with announcing(said.append):
        assert (one(1), other(1)) == (2, 3)
    assert len(said) == 1
    assert "Compiling" in said[0]
    with announcing(said.append):
        assert one(2) == 3
    assert len(said) == 1
