# %% [markdown]
# # A loop of your own
#
# The convex core of the tuner knows no hydraulics. It takes any plant, as a function of s, an array
# of responses or an object of python-control, and any controller that is linear in its parameters.
# Here a level loop with dead time gets the largest integral gain, and with it the least integrated
# error after a load step, that a sensitivity peak of 1.4 allows.

# %%
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import mptune

PLOTS = Path("reports/examples")
PLOTS.mkdir(parents=True, exist_ok=True)

plant = mptune.RationalPlant([], [-1, -1, -1], gain=1, delay=0.2)
designs = {
    "PI": mptune.design(plant, mptune.pi_structure(), maximise="k_i", sensitivity_peak=1.4),
    "PID": mptune.design(plant, mptune.pid_structure(0.05), maximise="k_i", sensitivity_peak=1.4),
}
for name, found in designs.items():
    print(f"{name}: {found.shaped.status}, {found.gains}")

# %% [markdown]
# A `RationalPlant` knows its poles and zeros, so that stability and the peak are certified at every
# frequency; of a mere function the result says `grid only`.

# %%
for name, found in designs.items():
    peak = found.verdicts[0]
    print(f"{name}: stability {found.stability}; peak {peak.attained:.4f} ≤ {peak.bound:.4f}")

# %%
omega = np.geomspace(0.05, 50, 600)
response = np.exp(-0.2j * omega) / (1 + 1j * omega) ** 3
figure, axes = plt.subplots(figsize=(6, 3.4), layout="constrained")
for name, found in designs.items():
    loop = response * found.structure.controller(found.shaped.parameters, omega)
    axes.loglog(omega, 1 / abs(1 + loop), label=name)
axes.axhline(1.4, color="black", linestyle="--", label="limit")
axes.set(xlabel="Frequency [rad/s]", ylabel="Sensitivity [–]")
axes.legend()
figure.savefig(PLOTS / "own_loop.svg")
