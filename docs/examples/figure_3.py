# %% [markdown]
# # Fig. 3: is the force loop what the theory says?
#
# Everything that follows rests on Eq. 11: the force follows its reference through two lags, whose
# time constants come from the bulk modulus that the controller believes and the one that there is.
# The force controller does not control pressures, so that this is an approximation. Fig. 3 asks how
# good it is, by exciting the simulated force loop with sines at many operating points.
#
# The paper looks at 21 start pressures; five of them show the same picture in a few seconds.

# %%
from pathlib import Path

import numpy as np

import mptune

PLOTS = Path("reports/examples")
PLOTS.mkdir(parents=True, exist_ok=True)

fewer = [
    'identification.pressures=["1 MPa", "3.75 MPa", "6.5 MPa", "9.25 MPa", "12 MPa"]',
    'identification.frequency=["2 rad/s", "200 rad/s"]',
    "identification.frequencies=14",
]
study = mptune.load_study("studies/boom/study.toml", fewer)
found = mptune.identify_loop(study)
print(found.headline)

# %%
found.plot().savefig(PLOTS / "figure_3.svg")

# %% [markdown]
# Light lines are the operating points, the solid one is their median, the dashed one is
# $G_F(s)\,e^{-sT_S/2}$. Up to 40 rad/s, where the outer loops live, the median stays within half a
# decibel:

# %%
for panel in found.panels:
    slow = panel.decibels[:, panel.omega <= 40]
    median = abs(np.nanmedian(slow, axis=0)).max()
    print(f"{panel.name}: median within {median:.2f} dB up to 40 rad/s")
    assert median < 0.5

# %% [markdown]
# The valves are ideal here, as in the paper. `identification.valve_delays = ["0 ms", "8 ms"]` shows
# what Fig. 3 cannot: the valve's delay sits inside the force loop.
