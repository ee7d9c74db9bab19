"""The knobs: a slider and number fields for each value, in groups."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import panel as pn

from mptune.explore.knobs import GROUPS, Knob

if TYPE_CHECKING:
    from collections.abc import Callable

    from mptune.explore.setting import HandSetting, Value
    from mptune.params.study import ResolvedStudy

_OPEN = {"Gains"}
_FIELD = 92  # px
_SLIDER = """
.bk-slider-title { white-space: nowrap; overflow: hidden; text-overflow: ellipsis; }
.noUi-target { background: var(--surface); border-color: var(--line); box-shadow: none; }
.noUi-connect { background: var(--accent); }
.noUi-handle { background: var(--ground); border: 2px solid var(--accent); box-shadow: none; }
.noUi-handle:focus { outline: 3px solid var(--accent); outline-offset: 2px; }
"""

_SAID_ONLY = """
label { position: absolute; width: 1px; height: 1px; overflow: hidden; clip-path: inset(50%); }
"""


class _Prompt:
    """What a hand turns is heard at once; Panel's widgets wait 50 ms for what else may come."""

    _debounce = 5  # ms


class _Slider(_Prompt, pn.widgets.FloatSlider):
    pass


class _RangeSlider(_Prompt, pn.widgets.RangeSlider):
    pass


class KnobRow:
    """One knob: a slider, and a field for each end of a range.

    Parameters
    ----------
    knob
        What it turns.
    turned
        Told of key and value in SI.
    """

    def __init__(self, knob: Knob, turned: Callable[[str, Value], None]) -> None:
        self._knob, self._turned = knob, turned
        self._quiet = False
        kind: Any = _RangeSlider if knob.is_range else _Slider
        unit = "" if knob.unit == "–" else f" [{knob.unit}]"
        self.slider = kind(
            name=f"{knob.symbol}{unit} {knob.meaning}",
            value=(0.0, 1.0) if knob.is_range else 0.0,
            start=0.0, end=1.0, show_value=False, sizing_mode="stretch_width", margin=(2, 8, 0, 8),
            stylesheets=[_SLIDER],
        )  # fmt: skip
        ends = ("least", "largest") if knob.is_range else ("",)
        self.fields = [
            pn.widgets.FloatInput(
                name=f"{knob.symbol}{unit} {end}".strip(), value=0.0, width=_FIELD,
                margin=(0, 4, 4, 4), format="0.[00000]", stylesheets=[_SAID_ONLY],
            )
            for end in ends
        ]  # fmt: skip
        self.slider.param.watch(self._slid, "value")
        for field in self.fields:
            field.param.watch(self._typed, "value")
        self.row: Any = pn.Row(self.slider, *self.fields, sizing_mode="stretch_width")
        if knob.is_range:
            fields = pn.Row(*self.fields, margin=(0, 4))
            self.row = pn.Column(self.slider, fields, sizing_mode="stretch_width")

    def place(self, setting: HandSetting, study: ResolvedStudy) -> None:
        """Let slider and fields stand where a setting has them; nobody is told."""
        low, high, step = self._knob.ends(study)
        value = setting.value(self._knob, study)
        shown = tuple(one / self._knob.scale for one in _pair(value))
        low, high = min(low / self._knob.scale, *shown), max(high / self._knob.scale, *shown)
        self._quiet = True
        try:
            with pn.io.hold():
                self.slider.param.update(
                    start=low, end=high, step=step / self._knob.scale,
                    value=shown if self._knob.is_range else shown[0],
                )  # fmt: skip
                for field, one in zip(self.fields, shown, strict=True):
                    field.value = float(f"{one:.9g}")
        finally:
            self._quiet = False

    def _slid(self, _: Any) -> None:
        if self._quiet:
            return
        self._quiet = True
        try:
            for field, one in zip(self.fields, _pair(self.slider.value), strict=True):
                field.value = float(f"{one:.9g}")
        finally:
            self._quiet = False
        self._tell(_pair(self.slider.value))

    def _typed(self, _: Any) -> None:
        """Let the slider follow what is typed, its ends giving way."""
        typed = [field.value for field in self.fields]
        values = tuple(float(one) for one in typed if one is not None)
        if self._quiet or len(values) < len(typed) or list(values) != sorted(values):
            return
        self._quiet = True
        try:
            self.slider.param.update(
                start=min(self.slider.start, *values), end=max(self.slider.end, *values),
                value=values if self._knob.is_range else values[0],
            )  # fmt: skip
        finally:
            self._quiet = False
        self._tell(values)

    def _tell(self, values: tuple[float, ...]) -> None:
        scaled = [float(f"{one * self._knob.scale:.12g}") for one in values]
        found: Value = (scaled[0], scaled[1]) if self._knob.is_range else scaled[0]
        self._turned(self._knob.key, found)


def _pair(value: Any) -> tuple[float, ...]:
    return tuple(value) if isinstance(value, tuple | list) else (value,)


class Controls:
    """Every knob, in groups that open and close."""

    def __init__(self, turned: Callable[[str, Value], None]) -> None:
        self.rows = {knob.key: KnobRow(knob, turned) for group in GROUPS.values() for knob in group}
        self.groups = {
            name: pn.Card(
                *(self.rows[knob.key].row for knob in group),
                title=name,
                collapsed=name not in _OPEN,
                sizing_mode="stretch_width",
                margin=(0, 0, 8, 0),
                css_classes=["group"],
            )
            for name, group in GROUPS.items()
        }

    def place(self, setting: HandSetting, study: ResolvedStudy) -> None:
        """Let every knob stand where a setting has it."""
        for row in self.rows.values():
            row.place(setting, study)
