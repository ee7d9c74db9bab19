"""Arrays of results, and the compiled kernels' cache."""

from __future__ import annotations

import os
import subprocess
import sys
from contextlib import nullcontext

import numpy as np
import pytest

from mptune import arrays
from mptune.arrays import frozen, lending_kernel


def test_a_frozen_array_cannot_be_changed():
    array = frozen(np.zeros(3))
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 1


def test_the_arrays_of_a_sweep_cannot_be_changed(fig_5):
    for array in (fig_5.omega, fig_5.velocity.left, fig_5.position.right, fig_5.velocity.plant):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


@pytest.mark.compiled
def test_kernels_work_where_no_cache_can_be_written(tmp_path):
    (tmp_path / "file").write_text("x")
    program = (
        "from mptune.loops.position import position_controller as g_p\n"
        "print(g_p(1j, 13.0, 22.0, 42.0, 0.55, 0.006))"
    )
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "file" / "sub")}
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True
    )
    expected = 13 * (-1 / 42**2 + 2j * 0.55 / 42 + 1) / (0.006j + 1) ** 2 - 22j
    assert complex(done.stdout) == pytest.approx(expected, rel=1e-12)


@pytest.mark.compiled
def test_a_lending_kernel_cannot_make_an_array_that_nobody_would_free(monkeypatch):
    monkeypatch.setattr(arrays, "kept_for", lambda _function: nullcontext(enter_result=False))
    with pytest.raises(Exception, match="zeros"):
        lending_kernel(lambda count: np.zeros(count).sum())(3)
