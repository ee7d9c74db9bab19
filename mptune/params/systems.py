"""The systems that the paper measures itself against (§7), and the rule that compares them.

The paper publishes figures of them and hardly a parameter. What was chosen so that a figure comes
out as published is *calibrated*, and its source says on what and over which range.
"""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, model_validator

from mptune.params.section import Range, Section, quantity, refuse

_FASTEST = 1e4  # 1/s, K_I/K_P of a cascade: with it, Eq. 22's gains stay within their own ranges


class LoadSensing(Section):
    """Electric load sensing with a mobile proportional valve."""

    rated_flow: float = quantity(
        "m^3/s",
        "Q_N",
        "inlet flow at full opening and the compensated pressure",
        at_least=1e-9,
        at_most=10,
    )
    compensated_pressure: float = quantity(
        "Pa",
        "Δp_c",
        "pressure that the compensator holds over the inlet edge",
        at_least=1e3,
        at_most=1e9,
    )
    meter_out_ratio: float = quantity(
        "1",
        "r_out",
        "area of the outlet edge over that of the inlet edge",
        at_least=1e-3,
        at_most=1e3,
    )
    spool_frequency: float = quantity(
        "rad/s", "ω_y", "natural frequency of the spool", at_least=0.1, at_most=1e5
    )
    spool_damping: float = quantity("1", "ζ_y", "damping of the spool", at_least=1e-3, at_most=100)
    spool_rate: float = quantity(
        "1/s", "y_r", "largest rate of the spool, per stroke", at_least=1e-3, at_most=1e5
    )
    dead_time: float = quantity("s", "d_y", "dead time of the spool", at_least=0, at_most=1)
    play: float = quantity("1", "b_y", "play, as a share of the stroke", at_least=0, at_most=0.2)
    dead_band: float = quantity(
        "1", "d_b", "dead band, as a share of the stroke", at_least=0, at_most=0.9
    )
    dead_band_known: float = quantity(
        "1", "κ", "share of the dead band that the controller steps across", at_least=0, at_most=1
    )
    margin: float = quantity(
        "Pa", "Δp_LS", "pump pressure above the load's", at_least=1e3, at_most=1e9
    )
    standby_pressure: float = quantity("Pa", "p_sb", "least pump pressure", at_least=0, at_most=1e9)
    pump_lag: float = quantity("s", "T_LS", "lag of the pump pressure", at_least=1e-4, at_most=10)
    k_x: float = quantity(
        "1/s", "K_x", "position gain of its literature", at_least=1e-3, at_most=1e3
    )


class _Switched(Section):
    """Valves that are switched, each with a delay of which its ramp is a part."""

    delay: Range = quantity("s", "d_v", "valve delay, opening ramp included", at_least=0, at_most=1)
    ramp: float = quantity(
        "s", "r_v", "opening ramp, part of the valve delay", at_least=1e-5, at_most=1
    )

    @model_validator(mode="after")
    def _ramp_is_part_of_the_delay(self) -> Self:
        if self.ramp > self.delay[0]:
            refuse("has a ramp longer than its smallest delay, of which it is a part", "shorten it")
        return self


class DigitalValves(_Switched):
    """Electric load sensing with four digital flow control units, one per edge."""

    flow_coefficient: float = quantity(
        "m^3/(s Pa^0.5)",
        "K_v,e",
        "flow coefficient of all valves of an edge",
        at_least=1e-12,
        at_most=1e-2,
    )
    back_pressure: float = quantity(
        "Pa", "p_back", "pressure wanted in the chamber that is drained", at_least=0, at_most=1e9
    )
    margin: float = quantity(
        "Pa", "Δp_LS", "pump pressure above the load's", at_least=1e3, at_most=1e9
    )
    standby_pressure: float = quantity("Pa", "p_sb", "least pump pressure", at_least=0, at_most=1e9)
    pump_lag: float = quantity("s", "T_LS", "lag of the pump pressure", at_least=1e-4, at_most=10)
    force_filter: float = quantity(
        "s",
        "τ_F",
        "time constant of the force that the steady state is solved for",
        at_least=1e-4,
        at_most=100,
    )
    weight_pressure: float = quantity(
        "m/(s Pa)", "W_p", "weight of the drained chamber's pressure error", at_least=0, at_most=1e3
    )
    weight_switching: float = quantity(
        "m/s", "W_sw,e", "weight of one valve switch", at_least=0, at_most=1e12
    )
    k_x: float = quantity(
        "1/s", "K_x", "position gain of its literature", at_least=1e-3, at_most=1e3
    )


class FourChamber(_Switched):
    """A cylinder of four chambers, areas 8:4:2:1, between two lines: secondary control."""

    smallest_area: float = quantity(
        "m^2", "A_1", "area of the smallest chamber", at_least=1e-6, at_most=10
    )
    dead_volume: float = quantity(
        "m^3", "V_0", "dead volume of each chamber", at_least=1e-9, at_most=10
    )
    low_pressure: float = quantity(
        "Pa", "p_LP", "pressure of the low line", at_least=0, at_most=1e9
    )
    high_pressure: float = quantity(
        "Pa", "p_HP", "pressure of the high line", at_least=1e3, at_most=1e9
    )
    flow_coefficient: float = quantity(
        "m^3/(s Pa^0.5)",
        "K_v,8",
        "flow coefficient of the largest chamber's valves, the others' in proportion",
        at_least=1e-12,
        at_most=1e-2,
    )
    least_flow_coefficient: float = quantity(
        "m^3/(s Pa^0.5)",
        "K_v,min",
        "least flow coefficient of a valve",
        at_least=1e-12,
        at_most=1e-2,
    )
    weight_compression: float = quantity(
        "N/J",
        "W_comp",
        "weight of the energy that a change of pressures costs",
        at_least=0,
        at_most=1e12,
    )
    weight_switching: float = quantity(
        "N", "W_sw", "weight of one valve switch", at_least=0, at_most=1e12
    )
    k_p_vel: float = quantity(
        "N s/m", "K_P,vel", "velocity gain of its literature", at_least=1, at_most=1e12
    )
    k_p_pos: float = quantity(
        "1/s", "K_P,pos", "position gain of its literature", at_least=1e-3, at_most=1e4
    )
    k_i_pos: float = quantity(
        "1/s^2", "K_I,pos", "integral gain of its literature", at_least=0, at_most=1e6
    )

    @model_validator(mode="after")
    def _pressures_are_ordered(self) -> Self:
        if not self.low_pressure < self.high_pressure:
            refuse("has a low_pressure not below its high_pressure", "check both pressures")
        return self


class PidLoop(Section):
    """Position control by PID with a filter, around the velocity gain (refs. 5 and 6)."""

    k_p_vel: float = quantity("N s/m", "K_P,vel", "velocity gain", at_least=1, at_most=1e12)
    k_p: float = quantity("1/s", "K_P", "position gain", at_least=1e-3, at_most=1e4)
    k_i: float = quantity("1/s^2", "K_I", "integral gain", at_least=0, at_most=1e6)
    derivative_time: float = quantity("s", "T_D", "derivative time", at_least=0, at_most=10)
    filter_time: float = quantity("s", "τ", "time constant of the filter", at_least=1e-4, at_most=1)


class CascadeLoop(Section):
    """Position control by P around velocity control by PI (refs. 5 and 6)."""

    k_p: float = quantity("N s/m", "K_P", "velocity gain", at_least=1, at_most=1e12)
    k_i: float = quantity(
        "N/m", "K_I", "integral gain of the velocity loop", at_least=0, at_most=1e12
    )
    k_x: float = quantity("1/s", "K_x", "position gain", at_least=1e-3, at_most=1e3)

    @model_validator(mode="after")
    def _integral_action_is_bounded(self) -> Self:
        if self.k_i > _FASTEST * self.k_p:
            refuse(f"has a k_i above {_FASTEST:g} 1/s times its k_p", "lower k_i or raise k_p")
        return self


class SteadyState(Section):
    """The study's own machine, deciding on the steady-state model (ref. 16).

    Table 2's weights do not carry over: settled pressures do not tell what a change of them costs.
    """

    weight_switching: float = quantity(
        "N", "W_sw", "weight of one valve switch", at_least=0, at_most=1e12
    )
    weight_loss: float = quantity(
        "N/J", "W_loss", "weight of energy losses", at_least=0, at_most=1e12
    )
    weight_compression: float = quantity(
        "N/J", "W_comp", "weight of compression energy", at_least=0, at_most=1e12
    )


class Systems(Section):
    """What is compared under the study's load and moves, and by which rule."""

    repeats: int = quantity(
        "1", "n", "movement sets per run, the first left out", 5, at_least=2, at_most=1000
    )
    gain_margin: float = quantity(
        "1", "g", "factor on the loop gain at which a best controller must still be stable", 1.5,
        at_least=1, at_most=100,
    )  # fmt: skip
    beside: tuple[Annotated[str, Field(min_length=1)], ...] = Field(
        (), description="files of further studies, whose machines are compared too", max_length=8
    )
    load_sensing: LoadSensing | None = Field(None, description="with a proportional valve")
    digital_valves: DigitalValves | None = Field(None, description="with digital valves")
    four_chamber: FourChamber | None = Field(None, description="a four-chamber cylinder")
    pid_loop: PidLoop | None = Field(None, description="this machine under PID")
    cascade_loop: CascadeLoop | None = Field(None, description="this machine under P and PI")
    steady_state: SteadyState | None = Field(
        None, description="this machine, deciding on settled pressures"
    )

    def parts(self) -> dict[str, Section]:
        """Return the systems that are compared, by the name of their section."""
        named = ((name, getattr(self, name)) for name in type(self).model_fields)
        return {name: part for name, part in named if isinstance(part, Section)}
