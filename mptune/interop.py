"""Results handed over to other libraries: figures, labelled data, tables, python-control's objects.

None of these libraries is imported before it is asked for.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import numpy as np

from mptune.errors import Fault, InputError
from mptune.strict import strict

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    import pandas as pd
    import xarray as xr
    from control import FrequencyResponseData, TransferFunction
    from matplotlib.figure import Figure

    from mptune.arrays import ComplexArray, FloatArray


class Result(Protocol):
    """What every result can do: say itself in JSON."""

    def json(self) -> dict[str, Any]:
        """Return the result in SI, units in the keys; None for what is not finite."""


class Drawn:
    """A result with drawings, by name in ``drawings``; the first is drawn where none is named."""

    __slots__ = ()
    drawings: ClassVar[Mapping[str, str]] = {}

    def plot(self, drawing: str = "") -> Figure:
        """Draw the result.

        Parameters
        ----------
        drawing
            A name of ``drawings``; the first where empty.

        Raises
        ------
        InputError
            If there is no such drawing.
        """
        name = drawing or next(iter(self.drawings))
        if name not in self.drawings:
            fault = Fault("drawing", repr(name), "is none", f"one of {', '.join(self.drawings)}")
            raise InputError(f"plot of {type(self).__name__}", fault)
        figure: Figure = _standing_at(self.drawings[name])(*self._drawn_with(name))
        return figure

    def _drawn_with(self, _drawing: str) -> tuple[Any, ...]:
        """Return what a drawing takes: the result itself."""
        return (self,)


class Labelled:
    """A result that is a labelled data set as well; ``dataset`` names what makes it."""

    __slots__ = ()
    dataset: ClassVar[str] = ""

    def to_xarray(self) -> xr.Dataset:
        """Return the result as a labelled data set, units in the attributes."""
        dataset: xr.Dataset = _standing_at(self.dataset)(self)
        return dataset


def _standing_at(place: str) -> Any:
    """Return what stands at ``"module:name"``.

    A result's drawing stands on a higher floor, and its data set is made by a module that itself
    knows the result. Imports point down only and never in a circle, so that a result names these
    in words, and this is the one place that follows such words.
    """
    module, _, name = place.partition(":")
    return getattr(importlib.import_module(module), name)


def to_pandas(results: Iterable[Result]) -> pd.DataFrame:
    """Return one row per result, as a data frame: linear moves, controllers compared, cases, links.

    Parameters
    ----------
    results
        Results of one kind. The columns are the keys of their JSON, those within others joined by
        a dot: ``gains.k_p_vel``, ``at.mass_kg``.
    """
    import pandas as pd

    return pd.json_normalize([strict(one.json()) for one in results])


def frequency_response(
    response: ComplexArray, omega: FloatArray, name: str, period: float | None = None
) -> FrequencyResponseData:
    """Return python-control's object of a response ``(F,)`` at ω ``(F,)`` [rad/s].

    Values are kept as they are, so that dead time stays exact. ``period`` [s] makes it a response
    in sampled time.

    Raises
    ------
    InputError
        If python-control is not installed.
    """
    found: FrequencyResponseData = _control().frd(
        np.asarray(response), np.asarray(omega), dt=_step(period), name=_name(name)
    )
    return found


def transfer_function(
    numerator: Sequence[float],
    denominator: Sequence[float],
    name: str,
    period: float | None = None,
) -> TransferFunction:
    """Return python-control's object of a fraction, falling powers of s, or of z at ``period`` [s].

    A fraction has no room for dead time. Powers of s that both sides have in common are cancelled.

    Raises
    ------
    InputError
        If python-control is not installed.
    """
    above, below = list(numerator), list(denominator)
    while len(above) > 1 and above[-1] == 0 and below[-1] == 0:
        del above[-1], below[-1]
    found: TransferFunction = _control().tf(above, below, dt=_step(period), name=_name(name))
    return found


def _step(period: float | None) -> float:
    return 0 if period is None else period  # 0 stands for continuous time there


def _name(name: str) -> str:
    return name.replace(".", "_")  # names there may have no dot


def _control() -> Any:
    try:
        return importlib.import_module("control")
    except ImportError as error:
        rule, remedy = "is not installed", "pip install 'control>=0.10'"
        raise InputError("to_control", Fault("", "python-control", rule, remedy)) from error
