"""The tables that report and terminal share: what each says of results that are not all well."""

from dataclasses import replace

import numpy as np
import pytest

from mptune.certify.result import Bracket
from mptune.params.controller import Feedforward
from mptune.params.estimator import Estimator
from mptune.report.blocks import Cell, verdict
from mptune.report.content.certificates import radii
from mptune.report.content.closed_loop import machines
from mptune.report.content.front import gains, requirements, tuning, warnings
from mptune.report.content.loops import condition_text, conditions, margins
from mptune.robust.result import Status
from mptune.robust.sweep import sweep
from mptune.tune.objective import Figures
from mptune.tune.result import Blocking, Concession, TuneResult, TuneStatus
from mptune.verify.result import CaseResult, CaseStatus, VerifyResult

pytestmark = pytest.mark.compiled  # interpreted, it would take minutes


@pytest.fixture(scope="module")
def swept(load_boom):
    """With plants that are unstable with the path: Fig. 5's delays counted there too."""
    return sweep(load_boom(corners=True, twice=True))


def column(table, heading):
    """Return the cells under a heading."""
    place = [one.text for one in table.columns].index(heading)
    return [row[place] for row in table.rows]


def test_conditions_of_one_set_of_gains_need_no_name_and_of_two_they_do(swept):
    one, two = conditions({"own": swept}), conditions({"own": swept, "tuned": swept})
    assert one.columns[0].text == "Condition"
    assert column(two, "Gains") == ["own", "own", "tuned", "tuned"]
    assert column(one, "Condition") == ["Eq. 17 (velocity)", "Eq. 21 (position)"]
    assert column(one, "Margin") == [f"{one.margin:.3f}" for one in swept.conditions]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({}, verdict("hold", good=True)),
        ({"nominal_stable": False}, verdict("nominal loop unstable", good=False)),
        ({"poles_equal": False}, verdict("unequal poles", good=False)),
        (
            {"nominal_stable": False, "poles_equal": False},
            verdict("nominal loop unstable, unequal poles", good=False),
        ),
    ],
)
def test_each_premise_that_fails_is_named(swept, change, words):
    changed = replace(swept, velocity=replace(swept.velocity, **change))
    assert column(conditions({"own": changed}), "Premises") == [words, verdict("hold", good=True)]


@pytest.mark.parametrize(("closed", "text"), [(True, "0"), (False, "—")])
def test_a_radius_without_a_finished_proof_is_a_dash(swept, closed, text):
    one = Bracket(0.0, 1.5, None, closed, boxes=7)
    found = radii(replace(swept.certificates, radii={"sampled": one}))
    assert column(found, "safe up to") == [text]


def test_a_ratio_at_vanishing_frequency_is_said_to_be_there(swept):
    limit = replace(swept.velocity, low_frequency_limit=True)
    assert "limit of vanishing frequency" in condition_text(limit)
    assert "24.5 t" in condition_text(swept.velocity)


def test_unstable_plants_stand_below_the_margins_of_their_loop(swept):
    filtered = swept.family("filters")
    assert filtered.unstable_count > 0
    last = margins(swept).rows[-1]
    assert last[0] == "unstable plants"
    unstable, at_all = filtered.unstable_count, int(np.sum(~filtered.velocity_stable))
    counts = [0, at_all, 0, unstable, 0, unstable, swept.sampled.unstable_count]
    assert last[1:] == [verdict(str(count), good=count == 0) for count in counts]
    assert margins(replace(swept, sampled=None)).rows[-1][-1] == "—"


def test_warnings_name_unstable_plants_and_what_could_not_be_checked(swept):
    (first,) = warnings(swept)
    count = swept.family("filters").unstable_count
    assert first.startswith(f"{count} of 16 plants are unstable with the measurement path")
    assert first.endswith("leave that path out.")
    unknown = replace(swept.checks[0], status=Status.NOT_EVALUATED)
    assert "cannot be evaluated" in warnings(replace(swept, checks=(unknown,)))[1]


def test_only_a_satisfied_requirement_looks_good(swept):
    checks = [replace(swept.checks[0], status=status) for status in Status]
    cells = column(requirements(checks), "Verdict")
    assert [cell.look for cell in cells] == ["good"] + ["bad"] * (len(Status) - 1)
    assert [cell.text for cell in cells] == [status.value for status in Status]


def test_feedforward_is_left_out_where_it_is_off_on_both_sides(swept):
    off, on = Feedforward(), Feedforward(acceleration_mass="24 t")
    six = len(gains((swept.gains,), (swept.gains,)).rows)
    assert len(gains((swept.gains, off), (swept.gains, off)).rows) == six
    filters, state = Estimator(), Estimator(kind="state")
    assert len(gains((swept.gains, filters), (swept.gains, filters)).rows) == six
    rows = gains((swept.gains, state), (swept.gains, filters)).rows[six:]
    assert [row[3] for row in rows] == ["40 rad/s", "by default"]
    for pair in ((on, off), (off, on)):
        table = gains((swept.gains, pair[0]), (swept.gains, pair[1]), "before")
        marks = {cell.text: n for n, cell in enumerate(column(table, "Key"))}
        row = table.rows[marks["acceleration_mass"]]
        masses = [Cell("24000 kg", "strong"), "0 kg"]
        assert row[2:4] == (masses if pair[0] is on else [Cell("0 kg", "strong"), "24000 kg"])


def test_a_blocked_tuning_says_what_blocks_and_what_would_have_to_give(swept):
    figures = Figures(0.014, 22.0, 1.3e-7, 16.0, 0.122)
    blocking = Blocking(
        "velocity_ratio", 0.5, None, "allow more", (Concession("noise_gain", 1.25),)
    )
    own = swept.gains
    tuned = TuneResult(
        TuneStatus.INFEASIBLE, "eq22", own, Feedforward(), Estimator(), own, Estimator(),
        replace(figures, tracking=0.011, disk_margin=0.61), figures, None, swept, blocking, (), (),
        0,
    )  # fmt: skip
    first, gained, blocked, relief = tuning(tuned)
    assert first == "Tuning: infeasible."
    assert "worst linear tracking index (sampled loop) 14.00 → 11.00 ms" in gained
    assert "0.13 → 0.13 mm/kN" in gained
    assert gained.endswith("disk margin α as it runs 0.122 → 0.61.")
    unasked = replace(tuned, figures=replace(figures, disk_margin=float("nan")))
    assert "disk margin" not in tuning(unasked)[1]
    assert blocked == "Blocked by velocity_ratio at —: allow more."
    assert relief == "With all else kept, noise_gain would have to give by a factor 1.25."


def test_a_machine_that_broke_a_limit_says_which_and_when(swept):
    broken = CaseResult(
        24500.0, (5e-3, 8e-3), 8e8, 9700.0, 3, CaseStatus.LIMIT_BROKEN, "piston at its end", 1.25,
        (), None, np.zeros((0, 16)),
    )  # fmt: skip
    table = machines(VerifyResult(swept.study, swept.gains, Feedforward(), (broken,)))
    words = "limit broken, piston at its end from 1.2 s on"
    assert column(table, "Status") == [verdict(words, good=False)]
    assert column(table, "Index\n[ms]") == ["—"]
