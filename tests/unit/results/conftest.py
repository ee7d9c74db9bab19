"""One of every public result, of known figures where computing them would take long."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mptune import (
    Baseline,
    Blocking,
    CampaignResult,
    CaseResult,
    CaseStatus,
    Energies,
    Excitation,
    Figures,
    Front,
    FrontPoint,
    IdentifyResult,
    JobResult,
    Limits,
    Panel,
    Recommendation,
    RunRecord,
    SetFigures,
    Stage,
    Trial,
    TuneResult,
    TuneStatus,
    VelocityGain,
    VerifyResult,
    Weights,
    WeightsResult,
    chain,
    design,
    fit_response,
    linear_moves,
    pi_structure,
    plan_campaign,
    sweep,
)  # fmt: skip
from mptune.campaign.simulate import FIGURES
from mptune.identify.fit import model
from mptune.identify.response import FrequencyResponse
from mptune.job.gains import gains_file
from mptune.params.judged_on import Difference
from mptune.robust.headline import judge
from mptune.verify.before_after import changes
from mptune.verify.beside import beside

UNKNOWN = float("nan")
NOTHING = Figures(UNKNOWN, 22.0, float("inf"), 16.0)  # of a loop that runs away
OMEGA = np.geomspace(1, 200, 400)


@pytest.fixture(scope="session")
def unstable(load_boom):
    """A sweep with unstable loops, on the corners of the box."""
    study = load_boom(corners=True)
    gains = study.study.gains
    return sweep(study, gains.model_copy(update={"k_p_vel": 4 * gains.k_p_vel}))


def panel_of(omega, count=300):
    """Return a panel of many operating points, some without a fit."""
    response = np.exp(-9e-3j * omega) * np.ones((count, 1))
    status = np.zeros(response.shape, np.int64)
    response[:3], status[:3] = np.nan, 1
    ones = np.ones(count)
    return Panel(
        position_m=0.1, oil_bulk_modulus_pa=8e8, valve_delay_s=0.0, tau_a_s=0.0, tau_b_s=0.0,
        omega=omega, velocity=ones, pressure_a=ones, skipped=2, response=response,
        quality=np.ones(response.shape), status=status, theory=np.exp(-9e-3j * omega),
    )  # fmt: skip


RECORD = RunRecord(
    0.5e-3, *np.ones((6, 2000)), np.ones(2000, np.bool_), np.array([1.0]), 0.1,
    Energies(3.0, 2.0, 0.0, 1.0, {"friction": 1.0}), pressures=np.ones((2000, 2)),
)  # fmt: skip


def case_of(mass, status=CaseStatus.STABLE):
    """Return a machine with twenty movement sets, or with none where it was not stable."""
    figures = (15.0, 19.0, 19.0, 41.0, 0.3, 111.0, 840, 0.6, 15.9, 1e-3, 3, 0.0)
    one = SetFigures(*figures, converter_peak_mm=50.0)
    stable = status is CaseStatus.STABLE
    return CaseResult(
        mass_kg=mass, valve_delay_s=(5e-3, 8e-3), oil_bulk_modulus_pa=1.2e9, load_force_n=9700.0,
        seed=1, status=status, broken="" if stable else "supply", broken_at_s=UNKNOWN,
        sets=(one,) * 20 if stable else (), record=RECORD, traces=np.ones((2000, 16)),
    )  # fmt: skip


def tuning_of(swept, figures=NOTHING):
    """Return a tuning that found no gains, for whose index there is no figure."""
    blocking = Blocking("velocity_ratio", float("inf"), swept.velocity.at, "allow more", ())
    return TuneResult(
        status=TuneStatus.INFEASIBLE, structure="eq22", gains=swept.gains,
        feedforward=swept.study.study.feedforward, estimator=swept.study.study.estimator,
        before=swept.gains, estimator_before=swept.study.study.estimator, figures=figures,
        figures_before=NOTHING, velocity=VelocityGain(0.0, "bounds", 0.0, 0), sweep=swept,
        blocking=blocking, binding=("velocity_ratio",), rounds=(), evaluations=10,
    )  # fmt: skip


def campaign_of(study):
    """Return a campaign of 1000 runs, all of whose figures are NaN in one and the rest 1."""
    plan = plan_campaign(study)
    figures = np.ones((plan.runs, len(FIGURES)))
    figures[17] = np.nan
    figures[:, FIGURES.index("valve_switches")] = np.nan
    status, reason = np.full(plan.runs, "stable", "U32"), np.full(plan.runs, "", "U64")
    status[17], reason[17] = "not finite", "not finite"
    return CampaignResult(plan, figures, status, reason)


def weights_of(study):
    """Return a search of 80 trials."""
    weights = Weights(100.0, 80.0, 2e11, 0.01, 5e-4, 7e-4)
    trial = Trial(weights, (1, 2) * 2, np.full((4, len(FIGURES)), np.nan), 1)
    found = Recommendation(trial, trial, np.full(4, np.nan), "because")
    steps = (Stage("weight_loss", trial, True),) * 22  # a named tuple's field
    limits = Limits(0.07, 5e5, 16e6)
    return WeightsResult(study, weights, steps, (trial,) * 80, (0, 1), limits, found)


@pytest.fixture(scope="session")
def results(fig_5, unstable, load_boom):
    """One of every public result by name."""
    study = fig_5.study
    response = FrequencyResponse(
        OMEGA, model(OMEGA, np.array([8e-3, 9e-3, 5e-3]), 0.57), np.ones(400), "<rig & co> no. 2"
    )
    cases = tuple(case_of(mass) for mass in np.linspace(2e4, 5e4, 40))
    verified = VerifyResult(
        study, fig_5.gains, study.study.feedforward, (*cases, case_of(6e4, CaseStatus.NOT_FINITE))
    )
    moves = linear_moves(study)
    lost = replace(moves[0], stable=False, performance_index_ms=UNKNOWN)
    tuned, links = tuning_of(unstable), chain(unstable)
    row = Baseline("p", TuneStatus.OPTIMAL, fig_5.gains, NOTHING, fig_5)
    point = FrontPoint(fig_5.gains, NOTHING, converged=False)
    panel = panel_of(OMEGA[::10])
    designed = design(
        lambda s: 1 / (s + 1) ** 3, pi_structure(), maximise="k_i", sensitivity_peak=1.4
    )
    return {
        "sweep": fig_5,
        "unstable": unstable,
        "condition": fig_5.velocity,
        "family": unstable.family("filters"),
        "sampled": fig_5.sampled,
        "check": fig_5.checks[0],
        "model": fig_5.model,
        "loops": fig_5.model.loops(fig_5.gains),
        "plants": fig_5.plants,
        "margins": unstable.family("none").margins,
        "sides": fig_5.model.sides(OMEGA, fig_5.gains),
        "link": links[0],
        "study": study,
        "whole study": study.study,
        "gains file": gains_file(fig_5, study.study.feedforward, moves, None),
        "tuned": tuned,
        "baseline": row,
        "front": Front((point,) * 40, NOTHING),
        "front point": point,
        "design": designed,
        "shaped": designed.shaped,
        "structure": designed.structure,
        "move": lost,
        "case": cases[0],
        "record": RECORD,
        "verified": verified,
        "plan": plan_campaign(study),
        "campaign": campaign_of(study),
        "panel": panel,
        "identified": IdentifyResult(study, Excitation.SINE, (panel,) * 12),
        "response": response,
        "fit": fit_response(response, 0.57),
        "weights": weights_of(study),
        "judgement": judge(fig_5.checks, links),
        "change": changes(verified, verified)[0],
        "papers frame": beside(verified, fig_5.gains, (0.014, UNKNOWN), verified),
        "difference": Difference("oil.bulk_modulus", "1.4e9", "—"),
        "job": JobResult(
            study,
            fig_5,
            tuned,
            (lost,),
            moves,
            verified,
            verified,
            links,
            judge(fig_5.checks, links),
            changes(verified, verified),
            (row,) * 5,
        ),
    }
