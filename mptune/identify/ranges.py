"""From fits to the ranges that a study's ``[uncertainty]`` takes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from mptune.errors import Fault, InputError
from mptune.escaping import comment_text
from mptune.identify.fitted import NAMES, Certainty, Fit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.params.section import Range
    from mptune.params.uncertainty import UncertaintySet

_DIGITS = 4
_LEAST_DELAY = 1e-6  # s: a study refuses none at all


def fitted_ranges(fits: Sequence[Fit], held: float = 0.0) -> dict[str, Range]:
    """Return the ranges of τ_A, τ_B and total delay that the fits speak for, confidence included.

    The machine's spread is not a record's confidence. N machines drawn evenly from a range lie
    inside it: it exceeds what they span by 1/(N − 1) of that at each end, on average. So much is
    added; one record spans nothing, and its range holds for the one state of the machine that it
    saw: it errs on the small side.

    Parameters
    ----------
    fits
        At least one.
    held
        Delay that the responses do not hold [s]: T_S/2 where the reference was recorded behind the
        hold of the sampled controller, as stairs. The study's delay is the total one.

    Raises
    ------
    InputError
        If there is no fit that converged.
    """
    usable = _usable(fits)
    if not usable:
        fault = Fault("", "", "has no response that Eq. 11 could be fitted to", "check the data")
        raise InputError("fit", fault)
    ranges = {}
    for name in NAMES:
        intervals = [getattr(one, name) for one in usable]
        added = held if name == "delay" else 0.0
        values = [one.value for one in intervals]
        beyond = (max(values) - min(values)) / max(len(values) - 1, 1)
        least = min(one.low for one in intervals) - beyond + added
        least = max(least, _LEAST_DELAY if name == "delay" else 0.0)
        ranges[name] = (least, max(one.high for one in intervals) + beyond + added)
    return ranges


def spread_in_words(fits: Sequence[Fit]) -> str:
    """Return what the ranges of these fits stand for, and what they do not."""
    count = len(_usable(fits))
    if count == 1:
        return (
            "One record: the intervals say how well it is known, not how far the machine varies. "
            "Record other positions, temperatures and loads, each with a --data of its own."
        )
    return (
        f"{count} records: the ranges hold all intervals and, at each end, 1/{count - 1} of what "
        "the records differ by, for the machine varies further than a few records show."
    )


def _basis(fits: Sequence[Fit]) -> str:
    count = len(_usable(fits))
    return (
        f"of {count} records, widened" if count > 1 else "of one record: not the machine's spread"
    )


def _usable(fits: Sequence[Fit]) -> list[Fit]:
    return [one for one in fits if one.certainty is not Certainty.NOT_CONVERGED]


def uncertainty_section(
    fits: Sequence[Fit], box: UncertaintySet, measured: Sequence[str], held: float = 0.0
) -> str:
    """Return an ``[uncertainty]`` section with the fitted ranges, as TOML.

    Mass, nominal plant and points are those of the study's set ``box``. The section takes the place
    of the study's own. The files ``measured`` stand ready as a comment: whether to judge by the
    responses themselves too is the user's choice.
    """
    import tomlkit

    ranges = fitted_ranges(fits, held)
    section = tomlkit.table()
    for one in fits:
        section.add(
            tomlkit.comment(
                comment_text(
                    f"{one.name}: {one.certainty.value}; least known {one.weakest}".replace(
                        "−", "-"
                    )
                )
            )
        )
    section.add(tomlkit.comment(_basis(fits)))
    if held:
        section.add(tomlkit.comment(f"delay: with {1e3 * held:g} ms of the hold added"))
    section.add("mass", [f"{value!r} kg" for value in box.mass])
    for name in ("delay", "tau_a", "tau_b"):
        section.add(name, list(_milliseconds(ranges[name])))
    section.add("points", box.points)
    if measured:
        files = ", ".join(f'"{comment_text(file)}"' for file in measured)
        section.add(
            tomlkit.comment(f"measured = [{files}]  # the responses as members of their own")
        )
        section.add(
            tomlkit.comment('measured_place = "beside"  # or "instead", within their bands')
        )
    nominal = {
        key: f"{value!r} {unit}"
        for key, unit in (("mass", "kg"), ("delay", "s"))
        if (value := getattr(box.nominal, key)) is not None
    }
    if nominal:
        section.add("nominal", nominal)
    document = tomlkit.document()
    document.add("uncertainty", section)
    return tomlkit.dumps(document)


def _milliseconds(pair: Range) -> tuple[str, str]:
    """Return a range in milliseconds, rounded outwards."""
    low, high = (1e3 * value for value in pair)
    step = 10.0 ** (math.floor(math.log10(max(high, 1e-6))) + 1 - _DIGITS)
    texts = (max(math.floor(low / step), 0) * step, math.ceil(high / step) * step)
    return f"{texts[0]:.{_DIGITS}g} ms", f"{texts[1]:.{_DIGITS}g} ms"
