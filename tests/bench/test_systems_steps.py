"""Every system with its integration's steps halved: no printed figure moves beyond its spread.

The systems' steps are a value of the run, this machine's are compiled in: a copy of the package
with half of each step runs beside the package itself. Runs of on/off valves part at a near-tie,
so that they are compared by means over movement sets, as they are printed.
"""

import json
import math
import shutil
import subprocess
import sys

import pytest

pytestmark = [pytest.mark.bench, pytest.mark.trial]

STEPS = {  # file: as it is, and halved
    "systems/bench.py": ("SUBSTEPS = 10 ", "SUBSTEPS = 20 "),
    "params/packed.py": ("SUBSTEPS = 5 ", "SUBSTEPS = 10 "),
    "sim/integrator.py": ("CALM_SUBSTEPS = 2 ", "CALM_SUBSTEPS = 4 "),
}
RUN = """
import json, sys
from mptune.job.systems import this_machine
from mptune.params.load import load_study
from mptune.systems.compare import load_cases
from mptune.systems.contender import contenders

study = load_study(sys.argv[1])
own = this_machine(study, study.study.gains, study.study.feedforward)
found = {}
for entrant in (*contenders(study), *own):
    for case in load_cases(study):
        outcome = entrant.literature.run(case, 1.0)
        peak = 1e3 * abs(outcome.record.velocity_reference).max()
        sets = [
            {
                "index [ms]": one.performance_index_ms,
                "over v_ref [ms]": one.performance_index_ms * one.peak_velocity_mm_s / peak,
                "loss [J/mm]": one.energy_loss_j_per_mm,
                "force error [kN2 s]": one.force_error_integral_kn2s,
                "switches": one.valve_switches,
            }
            for one in outcome.sets
        ]
        returned = outcome.returned_j_per_mm
        found[f"{entrant.key}, {case.mass / 1e3:g} t"] = (sets, returned)
print(json.dumps(found))
"""


def figures_of(folder, study_file):
    command = [sys.executable, "-c", RUN, str(study_file)]
    done = subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def spread(values):
    return max(values) - min(values)


def test_half_the_step_moves_no_printed_figure_by_more_than_its_spread(root, study_file, tmp_path):
    shutil.copytree(root / "mptune", tmp_path / "mptune")
    for name, (whole, half) in STEPS.items():
        file = tmp_path / "mptune" / name
        text = file.read_text(encoding="utf-8")
        assert text.count(whole) == 1
        file.write_text(text.replace(whole, half), encoding="utf-8")
    whole, halved = figures_of(root, study_file), figures_of(tmp_path, study_file)
    print()
    differing = 0
    for run, (sets, returned) in whole.items():
        others, returned_too = halved[run]
        for name in sets[0]:
            one, two = [each[name] for each in sets], [each[name] for each in others]
            means = sum(one) / len(one), sum(two) / len(two)
            if any(map(math.isnan, means)):  # no force is controlled
                continue
            room = max(spread(one), spread(two))
            print(f"{run}: {name} {means[0]:.5g} → {means[1]:.5g}, spread {room:.3g}")
            assert abs(means[0] - means[1]) <= room
            differing += means[0] != means[1]
        of_loss = spread([each["loss [J/mm]"] for each in sets])  # the last set's alone
        print(f"{run}: returned {returned:.4g} → {returned_too:.4g} J/mm")
        assert abs(returned - returned_too) <= of_loss
    assert differing > len(whole)  # the copy ran with its own steps
