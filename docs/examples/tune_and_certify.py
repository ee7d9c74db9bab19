# %% [markdown]
# # Tune and certify
#
# The tuner starts from the published gains and makes the tracking index small, within the ratios of
# Eq. 17 and 21 and the noise that the published gains have. It searches on few plants and ends with
# a certificate over the whole box: what that finds beyond the search's plants joins them.

# %%
from pathlib import Path

import mptune

PLOTS = Path("reports/examples")
PLOTS.mkdir(parents=True, exist_ok=True)

study = mptune.load_study("studies/boom/study.toml", ["uncertainty.points=3"])
tuned = mptune.tune_gains(study)
print(tuned.headline)
print("\n".join(f"{key} = {value:.4g}" for key, value in tuned.gains.model_dump().items()))

# %% [markdown]
# What holds the tuner back is named, and every requirement says what it rests on:

# %%
print("binding:", ", ".join(tuned.binding))
for check in tuned.sweep.checks:
    print(f"{check.label}: {check.status}, {check.grounds or 'no family asked'}")

# %%
tuned.plot().savefig(PLOTS / "tuned.svg")

# %% [markdown]
# The verdict rests on every model of the loop, not on the two inequalities alone:

# %%
judgement = mptune.judge_sweep(tuned.sweep)
print(judgement.line)
assert judgement.met
