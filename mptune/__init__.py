"""mptune: robust-control design and tuning for multi-pressure hydraulic cylinders.

Where each equation of the paper stands:

=========  ==========================================================
Equation   Module
=========  ==========================================================
1          ``mptune.plant.machine``
2, 3       ``mptune.plant.flow``, ``mptune.force.search_space``
4          ``mptune.plant.bulk``
5          ``mptune.force.estimator``
6          ``mptune.force.search_space``
7, 8       ``mptune.force.cost``, ``mptune.force.select``; beyond the paper's
           own decision ``mptune.force.horizon``, ``mptune.force.dynamic``,
           ``mptune.force.steady``
9, 10      ``mptune.force.stop``
11, 12     ``mptune.loops.force_dynamics``
14-16, 18  ``mptune.loops.velocity``
17, 21     ``mptune.robust.condition``
19, 20     ``mptune.loops.position``
22         ``mptune.loops.position``; discrete in ``mptune.signals.tustin``;
           the loop as it runs in ``mptune.loops.sampled``
23         ``mptune.signals.differentiator``
=========  ==========================================================

Table 1 and 2 and §5.1 are values of ``studies/boom/study.toml``; where mptune differs from the
paper, and why, stands in ``mptune.params.paper``.

The public names are imported when they are first used. Whatever a public function takes or returns,
and whatever their methods and fields hold, is public as well. Only the sections of a study below
``Study`` stay in ``mptune.params``, one module for each part of the machine and of the controller.

=============================  =====================================================================
To                             use
=============================  =====================================================================
read and write                 ``load_study``, ``read_gains``, ``write_gains``
judge gains                    ``sweep``, ``chain``, ``judge_sweep``, ``LinearModel``,
                               ``linear_moves``; elsewhere: ``gains_for``
tune                           ``tune_gains``, ``baselines``, ``front``
tune any loop                  ``design`` with ``pi_structure`` and others, ``structure_of``
ask the nonlinear machine      ``verify_gains``; ``plan_campaign``, ``workers``, ``run_campaign``;
                               ``search_weights``; ``ForceController``
compare other actuators        ``compare_systems``
identify                       ``identify_loop``, ``fit_response``, ``read_response``, ``from_frd``
do it all                      ``run``
hand results over              ``.plot()``, ``.json()``, ``.to_xarray()``, ``.to_pandas()``,
                               ``.to_control()``; ``to_pandas``, ``controller_to_control``
=============================  =====================================================================
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mptune.campaign.campaign import run_campaign
    from mptune.campaign.draw import Box, Draw
    from mptune.campaign.guarantee import Guarantee
    from mptune.campaign.plan import Plan, plan_campaign
    from mptune.campaign.result import CampaignResult
    from mptune.campaign.workers import Workers, workers
    from mptune.certify.problem import BoxedLoop, PlantBox, Point
    from mptune.certify.result import Bound, BoxStability, Bracket, Grounds, Stability
    from mptune.errors import Fault, InputError, MptuneError, OutputError
    from mptune.force.controller import ForceController, Measured
    from mptune.identify.excitation import Excitation
    from mptune.identify.fit import fit as fit_response
    from mptune.identify.fitted import Certainty, Fit, Interval
    from mptune.identify.identify import identify as identify_loop
    from mptune.identify.response import FrequencyResponse
    from mptune.identify.responses import from_frd, read_response, write_response
    from mptune.identify.result import Agreement, Band, FitStatus, IdentifyResult, Panel
    from mptune.interop import Result, to_pandas
    from mptune.job.result import JobResult
    from mptune.job.run import run
    from mptune.job.systems import compare_systems
    from mptune.loops.family import FamilyLoops
    from mptune.params.chambers import Side
    from mptune.params.controller import Feedforward, Gains
    from mptune.params.doubts import Doubt
    from mptune.params.gains import GainsFile, gains_for, read_gains, write_gains
    from mptune.params.headline import Headline
    from mptune.params.judged_on import Difference
    from mptune.params.load import load_study
    from mptune.params.packed import LoopGains, MeasurementPath, NominalPlant, Plants
    from mptune.params.paper import LEDGER, PUBLISHED_GAINS
    from mptune.params.study import ResolvedStudy, Study
    from mptune.params.valve_states import EdgeRule, StateKind
    from mptune.progress import Progress
    from mptune.robust.certificates import Certificates
    from mptune.robust.chain import Link, chain
    from mptune.robust.condition import Sides
    from mptune.robust.family import Family
    from mptune.robust.headline import Judgement, judge, judge_sweep
    from mptune.robust.margins import Margins
    from mptune.robust.measured import ForceResponse, Members
    from mptune.robust.model import LinearModel
    from mptune.robust.place import PlantPoint
    from mptune.robust.result import Check, Condition, Status, SweepResult
    from mptune.robust.sweep import sweep
    from mptune.robust.transfer import controller_to_control
    from mptune.shape.cones import Concave, Cone
    from mptune.shape.design import Design, design
    from mptune.shape.problem import Function, Linear, Norm, Peak
    from mptune.shape.procedure import Iterate, ShapeStatus, Use
    from mptune.shape.proofs import PeakVerdict
    from mptune.shape.rational import RationalPlant
    from mptune.shape.shaping import Relief, Shaped
    from mptune.shape.structure import Structure
    from mptune.shape.structure import basis_of as structure_of
    from mptune.shape.structure import p as p_structure
    from mptune.shape.structure import pi as pi_structure
    from mptune.shape.structure import pid as pid_structure
    from mptune.shape.structure import position as position_structure
    from mptune.sim.judge import SetFigures
    from mptune.sim.record import BrokenLimit, CommandedSpeed, Energies, RunRecord
    from mptune.sim.sampled import LinearMove, linear_moves
    from mptune.systems.outcome import Outcome
    from mptune.systems.result import CalibratedValue, SystemRun, SystemsResult
    from mptune.tune.baselines import Baseline, baselines
    from mptune.tune.front import Front, FrontPoint, front
    from mptune.tune.objective import Figures
    from mptune.tune.result import Blocking, Concession, Round, TuneResult, TuneStatus
    from mptune.tune.tuner import tune as tune_gains
    from mptune.tune.velocity import VelocityGain
    from mptune.verify.before_after import Change, Mark
    from mptune.verify.before_after import changes as machine_changes
    from mptune.verify.beside import PapersFrame
    from mptune.verify.checks import machine_checks
    from mptune.verify.result import CaseResult, CaseStatus, VerifyResult
    from mptune.verify.verify import verify as verify_gains
    from mptune.weigh.procedure import Stage
    from mptune.weigh.recommend import Recommendation
    from mptune.weigh.result import WeightsResult
    from mptune.weigh.trial import Limits, Trial, Weights
    from mptune.weigh.weigh import search_weights

# Where each name lives, and what it is called there where it has another name here. Rooms are
# packages of mptune, so that no public name may be that of a room.
_MODULES = {
    "campaign.campaign": "run_campaign",
    "campaign.draw": "Box, Draw",
    "campaign.guarantee": "Guarantee",
    "campaign.plan": "Plan, plan_campaign",
    "campaign.result": "CampaignResult",
    "campaign.workers": "Workers, workers",
    "certify.problem": "BoxedLoop, PlantBox, Point",
    "certify.result": "Bound, BoxStability, Bracket, Grounds, Stability",
    "errors": "Fault, InputError, MptuneError, OutputError",
    "force.controller": "ForceController, Measured",
    "identify.excitation": "Excitation",
    "identify.fit": "fit as fit_response",
    "identify.fitted": "Certainty, Fit, Interval",
    "identify.identify": "identify as identify_loop",
    "identify.response": "FrequencyResponse",
    "identify.responses": "from_frd, read_response, write_response",
    "identify.result": "Agreement, Band, FitStatus, IdentifyResult, Panel",
    "interop": "Result, to_pandas",
    "job.result": "JobResult",
    "job.run": "run",
    "job.systems": "compare_systems",
    "loops.family": "FamilyLoops",
    "params.controller": "Feedforward, Gains",
    "params.doubts": "Doubt",
    "params.chambers": "Side",
    "params.gains": "GainsFile, gains_for, read_gains, write_gains",
    "params.headline": "Headline",
    "params.judged_on": "Difference",
    "params.load": "load_study",
    "params.packed": "LoopGains, MeasurementPath, NominalPlant, Plants",
    "params.paper": "LEDGER, PUBLISHED_GAINS",
    "params.study": "ResolvedStudy, Study",
    "params.valve_states": "EdgeRule, StateKind",
    "progress": "Progress",
    "robust.certificates": "Certificates",
    "robust.chain": "Link, chain",
    "robust.condition": "Sides",
    "robust.family": "Family",
    "robust.headline": "Judgement, judge, judge_sweep",
    "robust.margins": "Margins",
    "robust.measured": "ForceResponse, Members",
    "robust.model": "LinearModel",
    "robust.place": "PlantPoint",
    "robust.result": "Check, Condition, Status, SweepResult",
    "robust.sweep": "sweep",
    "robust.transfer": "controller_to_control",
    "shape.cones": "Concave, Cone",
    "shape.design": "Design, design",
    "shape.problem": "Function, Linear, Norm, Peak",
    "shape.procedure": "Iterate, ShapeStatus, Use",
    "shape.proofs": "PeakVerdict",
    "shape.rational": "RationalPlant",
    "shape.shaping": "Relief, Shaped",
    "shape.structure": (
        "Structure, basis_of as structure_of, p as p_structure, pi as pi_structure, pid as "
        "pid_structure, position as position_structure"
    ),
    "sim.judge": "SetFigures",
    "sim.record": "BrokenLimit, CommandedSpeed, Energies, RunRecord",
    "sim.sampled": "LinearMove, linear_moves",
    "systems.outcome": "Outcome",
    "systems.result": "CalibratedValue, SystemRun, SystemsResult",
    "tune.baselines": "Baseline, baselines",
    "tune.front": "Front, FrontPoint, front",
    "tune.objective": "Figures",
    "tune.result": "Blocking, Concession, Round, TuneResult, TuneStatus",
    "tune.tuner": "tune as tune_gains",
    "tune.velocity": "VelocityGain",
    "verify.before_after": "Change, Mark, changes as machine_changes",
    "verify.checks": "machine_checks",
    "verify.beside": "PapersFrame",
    "verify.result": "CaseResult, CaseStatus, VerifyResult",
    "verify.verify": "verify as verify_gains",
    "weigh.procedure": "Stage",
    "weigh.recommend": "Recommendation",
    "weigh.result": "WeightsResult",
    "weigh.trial": "Limits, Trial, Weights",
    "weigh.weigh": "search_weights",
}
_HOMES = {
    name.split(" as ")[-1]: (f"mptune.{module}", name.split(" as ", maxsplit=1)[0])
    for module, names in _MODULES.items()
    for name in names.split(", ")
}

__all__ = [
    "LEDGER", "PUBLISHED_GAINS", "Agreement", "Band", "Baseline", "Blocking", "Bound", "Box",
    "BoxStability", "BoxedLoop", "Bracket", "BrokenLimit", "CalibratedValue", "CampaignResult",
    "CaseResult", "CaseStatus", "Certainty", "Certificates", "Change", "Check", "CommandedSpeed",
    "Concave", "Concession", "Condition", "Cone", "Design", "Difference", "Doubt", "Draw",
    "EdgeRule", "Energies", "Excitation", "Family", "FamilyLoops", "Fault", "Feedforward",
    "Figures", "Fit", "FitStatus", "ForceController", "ForceResponse", "FrequencyResponse", "Front",
    "FrontPoint", "Function", "Gains", "GainsFile", "Grounds", "Guarantee", "Headline",
    "IdentifyResult", "InputError", "Interval", "Iterate", "JobResult", "Judgement", "Limits",
    "Linear", "LinearModel", "LinearMove", "Link", "LoopGains", "Margins", "Mark", "Measured",
    "MeasurementPath", "Members", "MptuneError", "NominalPlant", "Norm", "Outcome", "OutputError",
    "Panel", "PapersFrame", "Peak", "PeakVerdict", "Plan", "PlantBox", "PlantPoint", "Plants",
    "Point", "Progress", "RationalPlant", "Recommendation", "Relief", "ResolvedStudy", "Result",
    "Round", "RunRecord", "SetFigures", "ShapeStatus", "Shaped", "Side", "Sides", "Stability",
    "Stage", "StateKind", "Status", "Structure", "Study", "SweepResult", "SystemRun",
    "SystemsResult", "Trial", "TuneResult", "TuneStatus", "Use", "VelocityGain", "VerifyResult",
    "Weights", "WeightsResult", "Workers", "baselines", "chain", "compare_systems",
    "controller_to_control", "design", "fit_response", "from_frd", "front", "gains_for",
    "identify_loop", "judge", "judge_sweep", "linear_moves", "load_study", "machine_changes",
    "machine_checks", "p_structure", "pi_structure", "pid_structure", "plan_campaign",
    "position_structure", "read_gains", "read_response", "run", "run_campaign", "search_weights",
    "structure_of", "sweep", "to_pandas", "tune_gains", "verify_gains", "workers", "write_gains",
    "write_response",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Import a public name from its home on first use."""
    if name in _HOMES:
        home, there = _HOMES[name]
        return getattr(importlib.import_module(home), there)
    raise AttributeError(f"module 'mptune' has no attribute {name!r}")


def __dir__() -> list[str]:
    """Return the public names."""
    return __all__
