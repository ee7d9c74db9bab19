"""Many runs on the nonlinear machine: done, gone on with, replayed, or searched for the worst."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mptune.campaign.adversary import SEARCH_NOISE, find_worst
from mptune.campaign.campaign import run_campaign
from mptune.campaign.plan import plan_campaign
from mptune.campaign.simulate import Controlled, reason_of, simulate
from mptune.campaign.workers import workers
from mptune.errors import Fault, InputError
from mptune.files import make_folder, write_whole
from mptune.params.gains import accepted_gains
from mptune.progress import silent

if TYPE_CHECKING:
    from mptune.campaign.adversary import WorstMachine
    from mptune.campaign.plan import Plan
    from mptune.campaign.result import CampaignResult
    from mptune.params.judged_on import Difference
    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.verify.result import CaseResult


def planned(
    study: ResolvedStudy, gains: str | Path | None, *, force: bool = False
) -> tuple[Plan, tuple[Difference, ...]]:
    """Return a study's campaign with a gains file; with the study's own gains where None.

    Returns
    -------
    tuple
        The campaign, and what differs from the model that the file was made for.

    Raises
    ------
    InputError
        If the file is of another controller, its margins are not satisfied and ``force`` is False,
        or the campaign cannot be run.
    """
    if gains is None:
        return plan_campaign(study), ()
    file, differs = accepted_gains(study, gains, force=force)
    return plan_campaign(file.put_over(study)), differs


def campaign_study(
    plan: Plan,
    out: str | Path,
    progress: Progress = silent,
    *,
    count: int | None = None,
    scheduler: str = "",
    resume: bool = False,
) -> tuple[CampaignResult, tuple[Path, ...]]:
    """Run a campaign on ``count`` processes or a cluster; store and draw it.

    Raises
    ------
    InputError
        If the folder holds chunks that do not fit, or the scheduler does not answer.
    """
    from mptune.figures.campaign import campaign_figure
    from mptune.figures.style import to_svg

    folder = make_folder(Path(out) / plan.study.name)
    with workers(count, scheduler) as team:
        result = run_campaign(plan, folder, team, progress, resume=resume)
    svg = write_whole(folder / "campaign.svg", to_svg(campaign_figure(result)))
    return result, (folder / "campaign.nc", svg)


def replay_run(
    plan: Plan, number: int, out: str | Path
) -> tuple[CaseResult, str, tuple[Path, ...]]:
    """Make one run of a campaign again, exactly; return it, why it fails, and its drawing.

    Raises
    ------
    InputError
        If the campaign has no run of that number.
    """
    if not 0 <= number < plan.runs:
        fault = Fault("", str(number), f"is no run of this campaign of {plan.runs}", "count from 0")
        raise InputError("--replay", fault)
    case = simulate(_shared(plan), plan.draw(number), number)
    reason = reason_of(case, plan.study.study.campaign.limits)
    return case, reason, (_drawn(plan, case, out, f"campaign-run-{number}"),)


def worst_machine(
    plan: Plan,
    figure: str,
    out: str | Path,
    progress: Progress = silent,
    *,
    count: int | None = None,
    scheduler: str = "",
) -> tuple[WorstMachine, tuple[Path, ...]]:
    """Search the box for the machine with the worst figure, and draw its traces."""
    with workers(count, scheduler) as team:
        worst = find_worst(plan, figure, team, progress=progress)
    case = simulate(_shared(plan), worst.draw, SEARCH_NOISE)
    return worst, (_drawn(plan, case, out, f"campaign-worst-{figure}"),)


def _shared(plan: Plan) -> Controlled:
    return Controlled(plan.study, plan.gains, plan.feedforward)


def _drawn(plan: Plan, case: CaseResult, out: str | Path, name: str) -> Path:
    from mptune.figures.machine import machine_traces
    from mptune.figures.style import to_svg

    folder = make_folder(Path(out) / plan.study.name)
    svg = to_svg(machine_traces(case, plan.feedforward))
    return write_whole(folder / f"{name}.svg", svg)
