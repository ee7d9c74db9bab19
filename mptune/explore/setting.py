"""What the sliders hold: how a study is changed by hand, as one frozen value.

A setting says what differs from the study as it is written, by the study's own keys in SI. So it
fits into an address, two of them can be compared, and the study that it makes is the one that
``--set`` makes of the same keys.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, get_args
from urllib.parse import parse_qsl, urlencode

from pydantic import ValidationError

from mptune.errors import Fault, InputError
from mptune.explore.knobs import KNOBS, SECTIONS, Knob, section_of
from mptune.params.load import faults_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.params.section import Range
    from mptune.params.study import ResolvedStudy

Value = float | tuple[float, float] | str

PLANTS = ("worst of Eq. 17", "worst of Eq. 21", "nominal", "lightest, fastest",
          "lightest, slowest", "heaviest, fastest", "heaviest, slowest")  # fmt: skip
"""Plants that can be looked at beside the nominal one."""

LOOPS = ("velocity", "position", "force")
"""Places where the loop is broken."""

KIND = "estimator.kind"
_WHERE = "the address"
_VIEWS = {"plant": PLANTS, "loop": LOOPS, "path": ("without", "with")}


@dataclass(frozen=True)
class HandSetting:
    """One state of the page.

    Attributes
    ----------
    study, uncertainty
        Names of the study and of its uncertainty set; empty for the first and the default.
    turned
        What differs from the study, by dotted key in SI, sorted by key.
    plant, loop, path
        What is looked at: the plant, where its loop is broken, and whether with its measurement
        path.
    """

    study: str = ""
    uncertainty: str = ""
    turned: tuple[tuple[str, Value], ...] = ()
    plant: str = PLANTS[0]
    loop: str = "force"
    path: str = "without"

    def value(self, knob: Knob, study: ResolvedStudy) -> float | Range:
        """Return what a knob stands at, in SI; ``study`` is the one as it is written."""
        found: Any = dict(self.turned).get(knob.key)
        return knob.value_in(study) if found is None else found

    def turn(self, key: str, value: Value, study: ResolvedStudy) -> HandSetting:
        """Return the setting with one value changed; back at the study's own it is none."""
        turned = dict(self.turned)
        own: Value = study.study.estimator.kind if key == KIND else KNOBS[key].value_in(study)
        if value == own:
            turned.pop(key, None)
        else:
            turned[key] = value
        return replace(self, turned=tuple(sorted(turned.items())))

    def looking(self, *, plant: str = "", loop: str = "", path: str = "") -> HandSetting:
        """Return the setting with another plant, loop or path looked at; what is empty stays."""
        return replace(
            self, plant=plant or self.plant, loop=loop or self.loop, path=path or self.path
        )

    def published(self) -> HandSetting:
        """Return the setting with everything turned back to what the study says."""
        return replace(self, turned=())

    def gains_from(self, values: dict[str, Value], study: ResolvedStudy) -> HandSetting:
        """Return the setting with several values changed, by dotted key."""
        found = self
        for key, value in values.items():
            if key in KNOBS:
                found = found.turn(key, value, study)
        return found

    def put_over(self, study: ResolvedStudy) -> ResolvedStudy:
        """Return the study that the setting makes of the one as it is written.

        Raises
        ------
        InputError
            If a value breaks the section's rules, in the words of a study file.
        """
        sections: dict[str, dict[str, Value]] = {}
        for key, value in self.turned:
            section, _, name = key.partition(".")
            sections.setdefault(section, {})[name] = value
        changed = {name: _validated(study, name, values) for name, values in sections.items()}
        box = changed.pop("uncertainty", study.uncertainty)
        inner = study.study.model_copy(update=changed)
        return study.model_copy(update={"study": inner, "uncertainty": box})

    def overrides(self, study: ResolvedStudy) -> tuple[str, ...]:
        """Return the setting as the texts of ``--set``."""
        return tuple(
            f"{study.key_of(key.partition('.')[2]) if key.startswith('uncertainty.') else key}"
            f"={_toml(key, value)}"
            for key, value in self.turned
        )

    def query(self) -> str:
        """Return the setting as the part of an address behind its question mark."""
        pairs = [(name, getattr(self, name)) for name in ("study", "uncertainty", *_VIEWS)]
        default = HandSetting()
        pairs = [(name, value) for name, value in pairs if value != getattr(default, name)]
        return urlencode([*pairs, *((key, _text(value)) for key, value in self.turned)])

    @classmethod
    def from_query(cls, query: str) -> HandSetting:
        """Return what an address says; keys that nobody knows are passed over.

        Raises
        ------
        InputError
            If a value is none of those that there are.
        """
        given = dict(parse_qsl(query.lstrip("?")))
        views: dict[str, Any] = {}
        for name, known in _VIEWS.items():
            if name in given:
                if given[name] not in known:
                    remedy = f"choose one of {', '.join(known)}"
                    raise InputError(_WHERE, Fault(name, given[name], "is not known", remedy))
                views[name] = given[name]
        turned = [
            (key, _parsed(key, text)) for key, text in sorted(given.items()) if _is_turned(key)
        ]
        names = {name: given[name] for name in ("study", "uncertainty") if name in given}
        return cls(turned=tuple(turned), **names, **views)


def _validated(study: ResolvedStudy, name: str, values: dict[str, Value]) -> Any:
    section = section_of(study, name)
    kept = {key: getattr(section, key) for key in type(section).model_fields}
    try:
        return SECTIONS[name].model_validate(
            {key: _listed(value) for key, value in {**kept, **values}.items()}, context={"si": True}
        )
    except ValidationError as error:
        faults = faults_of(error, SECTIONS[name])
        named = [replace(one, key=f"{name}.{one.key}" if one.key else name) for one in faults]
        raise InputError("the page", *named) from error


def _listed(value: Any) -> Any:
    """Return a pair of numbers as a list, which is how a range is written."""
    numbers = isinstance(value, tuple) and value and isinstance(value[0], float)
    return list(value) if numbers else value


def _is_turned(key: str) -> bool:
    return key in KNOBS or key == KIND


def _text(value: Value) -> str:
    return "..".join(map(repr, value)) if isinstance(value, tuple) else str(value)


def _toml(key: str, value: Value) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    unit = KNOBS[key].si_unit
    if unit == "1":
        return repr(value)
    pair = isinstance(value, tuple)
    texts = [f'"{one!r} {unit}"' for one in (value if isinstance(value, tuple) else (value,))]
    return f"[{', '.join(texts)}]" if pair else texts[0]


def _parsed(key: str, text: str) -> Value:
    """Return a value of an address."""
    if key == KIND:
        kinds = get_args(SECTIONS["estimator"].model_fields["kind"].annotation)
        if text in kinds:
            return text
        raise InputError(_WHERE, Fault(key, text, "is not known", f"choose {' or '.join(kinds)}"))
    parse: Callable[[str], float] = float
    try:
        numbers = tuple(parse(part) for part in text.split(".."))
    except ValueError:
        numbers = ()
    if len(numbers) != (2 if KNOBS[key].is_range else 1):
        wanted = "two numbers like 1..2" if KNOBS[key].is_range else "a number"
        raise InputError(_WHERE, Fault(key, repr(text), "cannot be read", f"give {wanted}, in SI"))
    return (numbers[0], numbers[1]) if len(numbers) == 2 else numbers[0]
