"""A campaign run to its end: on all cores or a cluster, chunk by chunk, and on after a kill."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from mptune.campaign.simulate import Controlled, simulate_rows
from mptune.campaign.store import CampaignStore
from mptune.claim import claimed
from mptune.params.gains import version
from mptune.progress import silent

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mptune.campaign.plan import Plan
    from mptune.campaign.result import CampaignResult
    from mptune.campaign.workers import Workers
    from mptune.progress import Progress

_BLOCK = 8  # runs per task: about half a second


def run_campaign(
    plan: Plan,
    folder: str | Path,
    team: Workers,
    progress: Progress = silent,
    *,
    resume: bool = False,
) -> CampaignResult:
    """Run a campaign, or what is missing of it, and merge its chunks into ``campaign.nc``.

    Parameters
    ----------
    plan
        The campaign.
    folder
        Where its files are written.
    team
        Who runs it; the results do not depend on that.
    progress
        Told of the stage ``"runs"``.
    resume
        Go on where an earlier campaign was interrupted.

    Raises
    ------
    InputError
        If the folder holds chunks and ``resume`` is False, chunks of another campaign, or a
        finished one of another seed; or another process runs a campaign there.
    OutputError
        If a file cannot be written.
    """
    store = CampaignStore(folder, plan)
    asked = plan.study.study.campaign
    with claimed(Path(folder), "campaign", f"a campaign of {plan.runs} runs, seed {asked.seed}"):
        store.begin(resume=resume)
        done = store.finished() if resume else None
        if done is None:
            _run_missing(plan, store, team, progress)
            return store.merge()
        store.discard_chunks()
        return done


def _run_missing(plan: Plan, store: CampaignStore, team: Workers, progress: Progress) -> None:
    missing = store.missing()
    blocks = [block for number in missing for block in _blocks(plan.chunks[number])]
    runs_done = plan.runs - sum(len(block) for block in blocks)
    progress("runs", runs_done / plan.runs)
    if not blocks:
        return
    shared = Controlled(plan.study, plan.gains, plan.feedforward)
    first = blocks[0][0]  # once here, so that workers on this machine find compiled kernels
    simulate_rows(shared, [(first, plan.draw(first))], version())
    tasks = (
        (shared, [(index, plan.draw(index)) for index in block], version()) for block in blocks
    )
    with closing(team.results(simulate_rows, tasks)) as results:
        for number in missing:
            rows = []
            for _ in _blocks(plan.chunks[number]):
                rows.append(next(results))
                runs_done += len(rows[-1].number)
                progress("runs", runs_done / plan.runs)
            store.write_chunk(number, rows)


def _blocks(chunk: range) -> Iterator[range]:
    for begin in range(0, len(chunk), _BLOCK):
        yield chunk[begin : begin + _BLOCK]
