"""Arrays of results, and the compiled kernels' cache."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from mptune import arrays
from mptune.arrays import frozen


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


@pytest.mark.parametrize(
    ("changed", "recompiles"),
    [
        ("loops/force_dynamics.py", True),  # a kernel
        ("params/pack.py", True),  # tuples that kernels take
        ("params/controller.py", True),  # what those are made from
        ("cli/show.py", False),
        ("report/pdf.py", False),
    ],
)
def test_kernels_are_compiled_anew_where_what_they_are_made_of_changes(
    tmp_path, changed, recompiles
):
    package = tmp_path / "mptune"
    shutil.copytree(Path(arrays.__file__).parent, package)
    hash_of = arrays.source_hash.__wrapped__
    before = hash_of(package)
    assert before == arrays.source_hash()
    with (package / changed).open("a", encoding="utf-8") as file:
        file.write("# changed\n")
    assert (hash_of(package) != before) == recompiles
