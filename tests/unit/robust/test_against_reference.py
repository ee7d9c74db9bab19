"""The sweep and the margins against a brute-force program that knows nothing of mptune."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from mptune.loops.broken import FORCE, VELOCITY
from mptune.loops.stability import count_unstable_poles
from mptune.robust.margins import family_margins
from mptune.robust.model import LinearModel
from mptune.robust.place import PlantPoint

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes

REFERENCE = Path(__file__).parents[2] / "reference"
LOOPS = {"velocity": VELOCITY, "force": FORCE}
GRID = np.geomspace(0.1, 1000, 200)


def rows_of(name):
    with (REFERENCE / name).open(encoding="utf-8", newline="") as stream:
        return list(csv.DictReader(stream))


def label(row):
    return " ".join(value for value in row.values() if value.isalnum() or "-" in value)


SENSITIVITY = rows_of("sensitivity.csv")
STABLE = [row for row in SENSITIVITY if row["unstable_poles"] == "0"]


@pytest.mark.parametrize("row", rows_of("worst_ratios.csv"), ids=label)
def test_the_worst_ratio_and_its_plant(request, row):
    result = request.getfixturevalue(row["set"].replace("-", "_"))
    condition = result.velocity if row["equation"] == "17" else result.position
    at, expected = condition.at, float(row["worst_ratio"])
    print(f"{row['set']} Eq. {row['equation']}: {condition.worst_ratio:.7f}, brute {expected:.7f}")
    assert condition.worst_ratio == pytest.approx(expected, rel=1e-4)
    for key in ("mass_kg", "delay_s", "tau_a_s", "tau_b_s"):
        assert getattr(at, key) == float(row[key])
    assert at.frequency_rad_s == pytest.approx(float(row["frequency_rad_s"]), rel=0.01)


def loop_of(row, boom):
    """Return the loop of the row's plant and path with the published gains."""
    model, keys = LinearModel.of(boom), ("mass_kg", "delay_s", "tau_a_s", "tau_b_s")
    at = PlantPoint(*(float(row[key]) for key in keys), frequency_rad_s=np.nan)
    return model.loops(model.gains, model.path_of(row["path"]), model.plant(at))


@pytest.mark.parametrize("row", STABLE, ids=label)
def test_the_sensitivity_peak_and_the_gain_margin(boom, row):
    margins = family_margins(GRID, loop_of(row, boom))
    which = LOOPS[row["loop"]]
    peak, at = margins.sensitivity_peak[which, 0], margins.sensitivity_frequency[which, 0]
    assert peak == pytest.approx(float(row["m_s"]), rel=1e-6)
    assert at == pytest.approx(float(row["frequency_rad_s"]), rel=1e-3)
    assert margins.gain_margin[which, 0] == pytest.approx(float(row["gain_margin"]), rel=1e-6)


@pytest.mark.parametrize("row", SENSITIVITY, ids=label)
def test_the_number_of_unstable_poles(boom, row):
    count = count_unstable_poles(loop_of(row, boom).broken_at(LOOPS[row["loop"]]))
    assert count.decided.all()
    assert count.unstable.tolist() == [int(row["unstable_poles"])]
