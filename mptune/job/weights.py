"""The force controller's weights searched, drawn, and written down for the study."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import tomlkit

from mptune.campaign.workers import workers
from mptune.claim import claimed
from mptune.escaping import comment_text
from mptune.files import make_folder, write_whole
from mptune.job.leftovers import keep
from mptune.params.controller import Controller
from mptune.progress import silent
from mptune.weigh.trial import Weights
from mptune.weigh.weigh import search_weights

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.params.study import ResolvedStudy
    from mptune.progress import Progress
    from mptune.weigh.recommend import Recommendation
    from mptune.weigh.result import WeightsResult

_ALWAYS = Weights._fields[:6]  # the rest is written where it was searched


def weights_study(
    study: ResolvedStudy,
    out: str | Path,
    progress: Progress = silent,
    *,
    storage: str = "",
    trials: int = 80,
    sampler: str = "tpe",
    seed: int = 1,
    also: Sequence[str] = (),
    sets: int = 3,
    count: int | None = None,
    scheduler: str = "",
) -> tuple[WeightsResult, tuple[Path, ...]]:
    """Search a study's weights; keep the search in ``weights.db`` where no storage is given.

    Raises
    ------
    InputError
        If optuna is missing, storage, sampler or scheduler cannot be used, or another process
        searches weights in the same folder.
    """
    from mptune.figures.style import to_svg
    from mptune.figures.weights import weights_figure

    folder = make_folder(Path(out) / study.name)
    with claimed(folder, "weights", "a search of weights"), workers(count, scheduler) as team:
        result = search_weights(
            study,
            team,
            storage or f"sqlite:///{(folder / 'weights.db').resolve()}",
            trials,
            sampler=sampler,
            seed=seed,
            also=also,
            sets=sets,
            progress=progress,
        )
    files = (
        write_whole(folder / "weights.toml", _section(result)),
        write_whole(folder / "weights.svg", to_svg(weights_figure(result))),
        keep(folder, "weights", study, _rows(result)),
    )
    return result, files


def _rows(result: WeightsResult) -> list[dict[str, Any]]:
    """Return the study's own weights, the recommended ones and the front, for the report."""
    values = result.json()
    front = [{"name": f"trial {one['trial']}", **one} for one in values["front"]]
    own = {"name": "the study's own", **values["own"]}
    return [
        own,
        {"name": "recommended", "reason": values["reason"], **values["recommended"]},
        *front,
    ]


def _changed(found: Recommendation, name: str) -> bool:
    """Return whether the recommended value is another than the study's own."""
    return bool(getattr(found.trial.weights, name) != getattr(found.own.weights, name))


def _section(result: WeightsResult) -> str:
    """Return the recommended weights as they stand in a study."""
    found = result.recommendation
    document = tomlkit.document()
    verdict = "dominate" if found.dominates else "do not dominate"
    document.add(
        tomlkit.comment(comment_text(f"Weights for {result.study.name}; they {verdict} its own:"))
    )
    document.add(tomlkit.comment(comment_text(found.reason)))
    document.add(tomlkit.comment("Gains belong to their weights: sweep or tune again with these."))
    table = tomlkit.table()
    for name, unit, symbol, meaning in Controller.quantities():
        if name in Weights._fields and (name in _ALWAYS or _changed(found, name)):
            value = getattr(found.trial.weights, name)
            item = tomlkit.item(value if unit == "1" else f"{value:.6g} {unit}")
            item.comment(f"{symbol}, {meaning}")
            table.add(name, item)
    document.add("controller", table)
    return tomlkit.dumps(document)
