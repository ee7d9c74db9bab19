"""Results do not depend on how kernels run: interpreted, compiled, on one core or on several."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np
import pytest

PROGRAM = """
import json
import numpy as np
from mptune.loops.family import FamilyLoops
from mptune.loops.stability import count_unstable_poles
from mptune.params.packed import (LoopGains, MeasurementPath, NominalPlant, Plants)
from mptune.robust.condition import sides
from mptune.robust.margins import family_margins

random = np.random.default_rng(5)
spans = ((20e3, 60e3), (0.005, 0.025), (0.0, 0.012), (0.0, 0.012), (0.57, 0.57))
plants = Plants(*(random.uniform(low, high, 9) for low, high in spans))
gains = LoopGains(700e3, 13.0, 22.0, 42.0, 0.55, 0.006)
path = MeasurementPath(0.0005, float(np.exp(-0.0005 / 0.012)), 0.012)
omega = np.geomspace(0.1, 1000, 40)
loops = FamilyLoops(plants, gains, path)
found = sides(omega, loops, NominalPlant(24500.0, 0.011))
margins = family_margins(omega, loops)
unstable = count_unstable_poles(loops).unstable
figures = [*found, *margins, unstable]
print(json.dumps([np.nan_to_num(np.asarray(figure, float)).ravel().tolist() for figure in figures]))
"""


def figures_of(**environment):
    environment = {**os.environ, **environment}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=True
    )
    return [np.array(figure) for figure in json.loads(done.stdout)]


@pytest.fixture(scope="module")
def compiled():
    return figures_of(NUMBA_NUM_THREADS="1")


@pytest.mark.compiled
def test_two_threads_give_the_same_bits_as_one(compiled):
    for one, other in zip(compiled, figures_of(NUMBA_NUM_THREADS="2"), strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.compiled
def test_interpreted_kernels_give_the_same_figures(compiled):
    for one, other in zip(compiled, figures_of(NUMBA_DISABLE_JIT="1"), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12)
