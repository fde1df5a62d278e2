"""No sum of the method goes through BLAS: its order depends on the machine and its threads."""

import ast
import importlib
import inspect
import os
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import palms

APART = ("cli", "client", "server", "evaluation", "plot", "io", "extraction", "inertial", "sample")
OTHERS = ("geodesy", "repair", "__main__")
PRODUCTS = {"dot", "vdot", "inner", "matmul", "einsum", "tensordot", "cov", "corrcoef"}


def modules():
    """Names of the modules that follow a phone."""
    found = pkgutil.walk_packages(palms.__path__, "palms.")
    names = (each.name.removeprefix("palms.") for each in found)
    return sorted(n for n in names if n.split(".")[0] not in (*APART, *OTHERS))


def products(source):
    """Lines with a product that numpy hands to BLAS."""
    for node in ast.walk(ast.parse(source)):
        multiplied = isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(
            node.op, ast.MatMult
        )
        named = isinstance(node, ast.Attribute) and node.attr in PRODUCTS
        whole = (
            isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "norm"
            and not node.keywords
        )  # fmt: skip
        if multiplied or named or whole:
            yield node.lineno


@pytest.mark.parametrize("name", modules())
def test_no_module_of_the_method_multiplies_by_blas(name):
    path = Path(inspect.getsourcefile(importlib.import_module(f"palms.{name}")))
    assert not list(products(path.read_text()))


def test_products_are_found():
    found = products("a @ b\nnp.dot(a, b)\na.einsum\nnp.linalg.norm(a)\nnp.linalg.norm(a, axis=1)")
    assert sorted(found) == [1, 2, 3, 4]


_PRINT = """
import hashlib, numpy as np
from palms.localizer import track
from palms.settings import Settings
from tests.properties.test_filter import RASTER, STEPS, scan
from tests.worlds import walk
tracks = [
    track(RASTER, scan(), walk(STEPS), Settings(), rng=1),
    track(RASTER, scan(), walk(STEPS), Settings.for_method("no-scan"), rng=1),
    track(RASTER, scan(), walk(STEPS), Settings.uniform().with_particles(30_000), rng=1),
]
print(hashlib.sha256(repr([t.estimates for t in tracks]).encode()).hexdigest())
"""


def test_same_seed_same_bits_on_any_number_of_blas_threads():
    digests = set()
    for threads in ("1", "2"):
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": threads, "MKL_NUM_THREADS": threads}
        done = subprocess.run(
            [sys.executable, "-c", _PRINT], env=environment, check=True, capture_output=True,
            text=True,
        )  # fmt: skip
        digests.add(done.stdout)
    assert len(digests) == 1
