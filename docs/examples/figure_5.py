# %% [markdown]
# # Fig. 5: both inequalities and both step responses
#
# The published gains on the paper's ranges: 24.5 to 49 t, 11 to 21.5 ms of delay, and pressure time
# constants up to 12 ms, seven points each: 2401 plants.

# %%
from pathlib import Path

import mptune

PLOTS = Path("reports/examples")
PLOTS.mkdir(parents=True, exist_ok=True)

study = mptune.load_study("studies/boom/study.toml")
result = mptune.sweep(study)
print(result.headline)

# %%
result.plot().savefig(PLOTS / "figure_5.svg")

# %% [markdown]
# Left: the family's error (band) must stay below the right-hand side (dashed). Right: the step
# responses of all plants, computed with exact dead time. The grid can only miss a plant; the
# certificate cannot. It holds for every plant between the grid's points and for every frequency:

# %%
for loop, condition in (("Eq. 17", result.velocity), ("Eq. 21", result.position)):
    proof = condition.certified
    print(f"{loop}: {proof.attained:.5f} is attained, {proof.bound:.5f} is never exceeded")
    print(f"        at {condition.at.headline}")
    assert proof.closed

# %% [markdown]
# Neither inequality knows the filters of the measured position. What they cost is seen at F_ref:

# %%
result.plot("nyquist").savefig(PLOTS / "figure_5_nyquist.svg")
for link in mptune.chain(result):
    print(f"{link.name}: the gain may rise by {link.factor:.3f}")
