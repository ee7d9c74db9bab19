# %% [markdown]
# # Gains into a C target
#
# `export` writes the whole controller as C99: one function that sets it up and one that is called
# every 0.5 ms. Here gains are tuned, exported, compiled with the system's compiler, and the
# controller is called as a target would. The coarse grid is for speed alone.

# %%
import ctypes
import shutil
import subprocess
import sys
from pathlib import Path

PLACE = Path("reports/examples/target")
PLACE.mkdir(parents=True, exist_ok=True)
STUDY = ("studies/boom/study.toml", "--set", "uncertainty.points=2", "--out", str(PLACE))


def mptune(*words):
    """Run a command as at the prompt, and show the first line that it prints."""
    done = subprocess.run(
        [sys.executable, "-m", "mptune.cli", *words], capture_output=True, text=True, check=True
    )
    print(done.stdout.splitlines()[0])


mptune("tune", *STUDY, "--quiet")
gains = PLACE / "boom" / "gains.toml"
mptune("export", str(gains), "--to", "c", "--study", *STUDY)

# %% [markdown]
# The numbers of the study are constant data; nothing is allocated. Without contraction of products
# and sums the valve commands are those of mptune's own simulator, bit for bit.

# %%
sources = PLACE / "boom" / "c"
library = (PLACE / "controller.so").resolve()
compiler = shutil.which("cc") or shutil.which("gcc") or sys.exit("no C compiler")
flags = ["-std=c99", "-O2", "-ffp-contract=off", "-shared", "-fPIC"]
files = [str(path) for path in sorted(sources.glob("*.c"))]
subprocess.run([compiler, *flags, "-o", str(library), *files, "-lm"], check=True)
for path in sorted(sources.iterdir()):
    print(f"{path.name}: {len(path.read_text().splitlines())} lines")

# %% [markdown]
# The piston rests in the middle and is asked for 5 mm more, so that the first decision pushes.


# %%
class Inputs(ctypes.Structure):
    """`mptune_inputs` of the header, in double precision."""

    _fields_ = [
        *[(f"reference_{n}", ctypes.c_double) for n in range(3)],  # position and its derivatives
        *[(name, ctypes.c_double) for name in ("position", "p_a", "p_b", "p_high", "p_low")],
        ("converter", ctypes.c_double * 4),
        ("further", ctypes.c_double * 1),  # pressures of chambers behind A and B: here none
    ]


class Outputs(ctypes.Structure):
    """`mptune_outputs` of the header."""

    _fields_ = [
        ("valve", ctypes.c_uint8 * 24),
        *[(name, ctypes.c_uint8) for name in ("state_a", "state_b", "state_further")],
        *[(name, ctypes.c_uint8) for name in ("stopped", "decided")],
        ("fault", ctypes.c_uint32),
        ("force_reference", ctypes.c_double),
    ]


target = ctypes.CDLL(str(library))
state, out = (ctypes.c_double * 512)(), Outputs()  # more than mptune_state takes
rest = Inputs(0.15, 0, 0, 0.15, 6.43e6, 6e6, 14e6, 2e6, (ctypes.c_double * 4)())
target.mptune_init(ctypes.byref(state), ctypes.byref(rest), ctypes.c_double(9.7e3))
rest.reference_0 = 0.155
target.mptune_step(ctypes.byref(state), ctypes.byref(rest), ctypes.byref(out))
print(f"F_ref {out.force_reference / 1e3:.1f} kN, fault {out.fault}, open: {sum(out.valve)} valves")
assert out.fault == 0
assert out.force_reference > 0
