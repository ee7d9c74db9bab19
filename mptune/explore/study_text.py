"""A setting's controller as a study file has it, to be copied into one."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mptune.explore.knobs import KNOBS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mptune.params.section import Section
    from mptune.params.study import ResolvedStudy


def as_toml(study: ResolvedStudy, keys: Sequence[str]) -> str:
    """Return the gains, and what else is turned, as a study file has them.

    Of the uncertainty nothing: it belongs to the machine, not to the controller.
    """
    wanted = dict.fromkeys([*(key for key in KNOBS if key.startswith("gains.")), *keys])
    lines: list[str] = []
    for name in ("gains", "controller", "estimator", "feedforward"):
        section: Section = getattr(study.study, name)
        units = {key: unit for key, unit, _, _ in section.quantities()}
        mine = [key.partition(".")[2] for key in wanted if key.startswith(f"{name}.")]
        if mine:
            lines += ["", f"[{name}]"]
        lines += [f"{key} = {_toml(getattr(section, key), units.get(key))}" for key in mine]
    return "\n".join(lines).strip() + "\n"


def _toml(value: object, unit: str | None) -> str:
    if unit is None:
        return f'"{value}"'
    return repr(value) if unit == "1" else f'"{value!r} {unit}"'
