"""Many simulations: how many, drawn how, from which ranges, and what must hold in each."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from mptune.params.section import Range, Section, quantity, refuse


class CampaignLimits(Section):
    """The largest allowed figures of a run; one above its limit has failed."""

    performance_index: float | None = quantity(
        "s", "e_max/v_max", "largest performance index", None, above=0
    )
    energy_loss: float | None = quantity(
        "J/m", "E_loss", "largest energy loss per travel", None, above=0
    )
    force_error_integral: float | None = quantity(
        "N^2 s", "∫ΔF²", "largest integral of the squared force error, per set", None, above=0
    )
    final_error: float | None = quantity(
        "m", "e_end", "largest final position error", None, above=0
    )


class Campaign(Section):
    """A campaign of runs on the nonlinear machine; a range that is not given is the study's own.

    Each parameter is drawn uniformly from its range, independently of the others. A machine keeps
    its valve delay for the whole run: that is harsher than a delay drawn at each switching.
    """

    method: Literal["monte carlo", "sobol", "grid"] = Field(
        "monte carlo", description="independent draws, scrambled Sobol' points, or a full grid"
    )
    runs: int | None = quantity(
        "1", "N", "runs, but of a grid; 1000", None, at_least=1, at_most=100_000_000
    )
    points: int | None = quantity(
        "1", "n", "grid points per parameter that varies; 3", None, at_least=2, at_most=101
    )
    seed: int = quantity(
        "1", "seed", "seed of parameters and noise", 1, at_least=0, at_most=2**63 - 1
    )
    sets: int = quantity(
        "1", "n", "movement sets per run; of several, the first is left out", 1,
        at_least=1, at_most=100_000,
    )  # fmt: skip
    chunk: int = quantity("1", "n_c", "runs per chunk file", 100, at_least=1, at_most=1_000_000)
    mass: Range | None = quantity("kg", "m", "effective inertia", None, at_least=10, at_most=1e7)
    valve_delay: Range | None = quantity(
        "s", "d_v", "valve delay, opening ramp included", None, at_least=0, at_most=1
    )
    oil_bulk_modulus: Range | None = quantity(
        "Pa", "B_oil", "oil bulk modulus", None, at_least=1e7, at_most=1e11
    )
    load_force: Range | None = quantity(
        "N", "F_load", "load force", None, at_least=-1e9, at_most=1e9
    )
    friction: Range = quantity(
        "1", "s_μ", "factor of Coulomb friction, stiction and viscous friction", (1.0, 1.0),
        at_least=0, at_most=1e3,
    )  # fmt: skip
    temperature: Range = quantity(
        "K", "T", "oil temperature; 313.15 K, 40 °C, changes nothing", (313.15, 313.15),
        at_least=250, at_most=400,
    )  # fmt: skip
    noise: Range = quantity(
        "1", "s_n", "factor of every sensor's noise", (1.0, 1.0), at_least=0, at_most=1e6
    )
    lines: Range | None = quantity(
        "1", "s_L", "hoses are lines with inertia where it is 0.5 or more; [0, 1] draws both", None,
        at_least=0, at_most=1,
    )  # fmt: skip
    pressure_gain_error_a: Range | None = quantity(
        "1", "ε_A", "relative gain error of side A's pressure sensor", None,
        at_least=-0.9, at_most=9,
    )  # fmt: skip
    pressure_gain_error_b: Range | None = quantity(
        "1", "ε_B", "relative gain error of side B's pressure sensor", None,
        at_least=-0.9, at_most=9,
    )  # fmt: skip
    pressure_offset_a: Range | None = quantity(
        "Pa", "o_A", "offset of side A's pressure sensor", None, at_least=-1e8, at_most=1e8
    )
    pressure_offset_b: Range | None = quantity(
        "Pa", "o_B", "offset of side B's pressure sensor", None, at_least=-1e8, at_most=1e8
    )
    position_hysteresis: Range | None = quantity(
        "m", "h_x", "hysteresis of the position sensor", None, at_least=0, at_most=1
    )
    position_resolution: Range | None = quantity(
        "m", "q_x", "resolution of the position sensor; 0 for none", None, at_least=0, at_most=1
    )
    distance: Range = quantity(
        "1", "s_A", "factor of every move's length", (1.0, 1.0), at_least=1e-6, at_most=1e3
    )
    duration: Range = quantity(
        "1", "s_T", "factor of every move's time", (1.0, 1.0), at_least=1e-3, at_most=1e3
    )
    limits: CampaignLimits = CampaignLimits()
    failure_probability: float | None = quantity(
        "1", "ε", "failure probability that must be undercut", None, above=0, at_most=1
    )
    doubt: float = quantity(
        "1", "δ", "one minus the confidence of the guarantee", 1e-6, above=0, at_most=0.5
    )

    @model_validator(mode="after")
    def _numbers_fit_the_method(self) -> Self:
        if self.method == "grid" and self.runs is not None:
            refuse("has runs for a grid, whose points decide their number", "give points instead")
        if self.method != "grid" and self.points is not None:
            refuse("has points for a method that has no grid", "give runs instead")
        if self.method != "monte carlo" and self.failure_probability is not None:
            refuse(
                f'has a failure_probability with method = "{self.method}", whose points are no '
                "independent draws and prove nothing about probabilities",
                'take method = "monte carlo"',
            )
        return self
