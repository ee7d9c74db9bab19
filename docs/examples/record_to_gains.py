# %% [markdown]
# # From a measured record to gains
#
# A rig's force loop is excited with a multisine while reference and force are recorded. `identify`
# makes a frequency response of the record, fits Eq. 11 with a dead time, and writes the ranges as a
# study's `[uncertainty]`. No rig is at hand, so that the record is made here: two lags of 8 and
# 6 ms, 12 ms of dead time, and noise.

# %%
import subprocess
import sys
from pathlib import Path

import numpy as np

import mptune

PLACE = Path("reports/examples/rig")
PLACE.mkdir(parents=True, exist_ok=True)

step, period, periods = 1e-3, 4.0, 6  # s, s, –
samples = round(period / step)
noise = np.random.default_rng(1)
lines = np.unique(np.round(np.geomspace(2, 130, 40))).astype(int)
spectrum = np.zeros(samples // 2 + 1, complex)
spectrum[lines] = np.exp(2j * np.pi * noise.random(lines.size))
omega = 2 * np.pi * np.arange(spectrum.size) / period
lags = (0.571 / (1 + 8e-3j * omega) + 0.429 / (1 + 6e-3j * omega)) * np.exp(-12e-3j * omega)
reference = np.fft.irfft(spectrum, samples)
scale = 10 / abs(reference).max()  # kN
force = np.fft.irfft(spectrum * lags, samples)
time = step * np.arange(samples * periods)
measured = scale * np.tile(force, periods) + 0.1 * noise.standard_normal(time.size)
columns = np.stack([time, scale * np.tile(reference, periods), measured], axis=1)
np.savetxt(PLACE / "rig.csv", columns, "%.6g", ",", header="t [s],F_ref [kN],F [kN]", comments="")

# %%
command = [
    *(sys.executable, "-m", "mptune.cli", "identify", "studies/boom/study.toml", "--quiet"),
    *("--data", str(PLACE / "rig.csv"), "--input", "F_ref [kN]", "--output", "F [kN]"),
    *("--time", "t [s]", "--period", "4 s", "--out", str(PLACE)),
]
done = subprocess.run(command, capture_output=True, text=True, check=False)
print(done.stdout)
assert done.returncode == 0, done.stderr

# %% [markdown]
# The section goes into a study of its own, which takes everything else from its base. One record
# is one operating point; several (`--data a.csv --data b.csv`) spread the ranges as the machine
# does. So narrow a box leaves much room for gain, and the inequalities do not see the position
# filter: a gain margin of the loop as it runs keeps the tuner away from the edge.

# %%
section = (PLACE / "boom" / "measured" / "uncertainty.toml").read_text(encoding="utf-8")
base = Path("studies/boom/study.toml").resolve().as_posix()
study_file = PLACE / "study.toml"
margin = "[requirements]\ngain_margin = 1.5\n"
study_file.write_text(f'base = "{base}"\n{section}\n{margin}', encoding="utf-8")

study = mptune.load_study(study_file, ["uncertainty.points=3"])
tuned = mptune.tune_gains(study)
print(tuned.headline)
print("\n".join(f"{key} = {value:.4g}" for key, value in tuned.gains.model_dump().items()))
assert tuned.sweep.satisfied
