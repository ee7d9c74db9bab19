"""What a report is made of: results that are there, and None or nothing for those that are not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mptune.robust.headline import judge

if TYPE_CHECKING:
    from collections.abc import Mapping

    from mptune.identify.result import Panel
    from mptune.params.controller import Feedforward
    from mptune.params.study import ResolvedStudy
    from mptune.robust.chain import Link
    from mptune.robust.encirclements import Encirclements
    from mptune.robust.headline import Judgement
    from mptune.robust.one_at_a_time import Influence
    from mptune.robust.result import SweepResult
    from mptune.sim.sampled import LinearMove
    from mptune.tune.result import TuneResult
    from mptune.verify.before_after import Change
    from mptune.verify.beside import PapersFrame
    from mptune.verify.result import VerifyResult


@dataclass(frozen=True)
class Leftovers:
    """What other commands have left in the study's folder, for the same model.

    Attributes
    ----------
    compared
        The controllers of ``tune --compare``, as its JSON has them.
    front
        The points of ``tune --front``, as its JSON has them.
    weights
        The weights of ``weights``: the study's own, the recommended ones, the front.
    systems
        The runs and the calibrated values of ``systems``, as its JSON has them.
    studies
        The rows of ``studies``, as its JSON has them.
    margins
        The points of ``tune --front N --along disk_margin``, as its JSON has them.
    panels
        Fig. 3's panels of ``identify``.
    figures
        Their figures: SVG bytes by name.
    left_out
        What could not be used, and why, in sentences.
    """

    compared: tuple[dict[str, Any], ...] = ()
    front: tuple[dict[str, Any], ...] = ()
    weights: tuple[dict[str, Any], ...] = ()
    panels: tuple[Panel, ...] = ()
    figures: Mapping[str, bytes] | None = None
    systems: tuple[dict[str, Any], ...] = ()
    studies: tuple[dict[str, Any], ...] = ()
    margins: tuple[dict[str, Any], ...] = ()
    left_out: tuple[str, ...] = ()


@dataclass(frozen=True)
class Results:
    """What a run has produced; the report shows what is there.

    ``feedforward`` is the one that goes with the gains swept.
    """

    study: ResolvedStudy
    sweep: SweepResult
    published: SweepResult
    feedforward: Feedforward
    tuned: TuneResult | None = None
    moves: tuple[LinearMove, ...] = ()
    moves_before: tuple[LinearMove, ...] = ()
    verified: VerifyResult | None = None
    verified_before: VerifyResult | None = None
    chain: tuple[Link, ...] = ()
    encirclements: tuple[Encirclements, ...] = ()
    influences: tuple[Influence, ...] = ()
    leftovers: Leftovers = Leftovers()
    judgement: Judgement | None = None
    changes: tuple[Change, ...] = ()
    papers_frame: PapersFrame | None = None

    @property
    def verdict(self) -> Judgement:
        """How the gains came out: as judged, else by what is here."""
        return self.judgement or judge(self.sweep.checks, self.chain)
