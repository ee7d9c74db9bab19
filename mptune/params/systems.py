"""The systems that the paper measures itself against (§7), and the rule that compares them.

The paper publishes figures of them and hardly a parameter. What was chosen so that a figure comes
out as published is *calibrated*, and its source says on what and over which range.
"""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from mptune.params.section import Range, Section, quantity, refuse


class LoadSensing(Section):
    """Electric load sensing with a mobile proportional valve."""

    rated_flow: float = quantity(
        "m^3/s", "Q_N", "inlet flow at full opening and the compensated pressure", above=0
    )
    compensated_pressure: float = quantity(
        "Pa", "Δp_c", "pressure that the compensator holds over the inlet edge", above=0
    )
    meter_out_ratio: float = quantity(
        "1", "r_out", "area of the outlet edge over that of the inlet edge", above=0
    )
    spool_frequency: float = quantity("rad/s", "ω_y", "natural frequency of the spool", above=0)
    spool_damping: float = quantity("1", "ζ_y", "damping of the spool", above=0)
    spool_rate: float = quantity("1/s", "y_r", "largest rate of the spool, per stroke", above=0)
    dead_time: float = quantity("s", "d_y", "dead time of the spool", at_least=0)
    play: float = quantity("1", "b_y", "play, as a share of the stroke", at_least=0, at_most=0.2)
    dead_band: float = quantity(
        "1", "d_b", "dead band, as a share of the stroke", at_least=0, at_most=0.9
    )
    dead_band_known: float = quantity(
        "1", "κ", "share of the dead band that the controller steps across", at_least=0, at_most=1
    )
    margin: float = quantity("Pa", "Δp_LS", "pump pressure above the load's", above=0)
    standby_pressure: float = quantity("Pa", "p_sb", "least pump pressure", at_least=0)
    pump_lag: float = quantity("s", "T_LS", "lag of the pump pressure", above=0)
    k_x: float = quantity("1/s", "K_x", "position gain of its literature", above=0)


class _Switched(Section):
    """Valves that are switched, each with a delay of which its ramp is a part."""

    delay: Range = quantity("s", "d_v", "valve delay, opening ramp included", at_least=0)
    ramp: float = quantity("s", "r_v", "opening ramp, part of the valve delay", above=0)

    @model_validator(mode="after")
    def _ramp_is_part_of_the_delay(self) -> Self:
        if self.ramp > self.delay[0]:
            refuse("has a ramp longer than its smallest delay, of which it is a part", "shorten it")
        return self


class DigitalValves(_Switched):
    """Electric load sensing with four digital flow control units, one per edge."""

    flow_coefficient: float = quantity(
        "m^3/(s Pa^0.5)", "K_v,e", "flow coefficient of all valves of an edge", above=0
    )
    back_pressure: float = quantity(
        "Pa", "p_back", "pressure wanted in the chamber that is drained", at_least=0
    )
    margin: float = quantity("Pa", "Δp_LS", "pump pressure above the load's", above=0)
    standby_pressure: float = quantity("Pa", "p_sb", "least pump pressure", at_least=0)
    pump_lag: float = quantity("s", "T_LS", "lag of the pump pressure", above=0)
    force_filter: float = quantity(
        "s", "τ_F", "time constant of the force that the steady state is solved for", above=0
    )
    weight_pressure: float = quantity(
        "m/(s Pa)", "W_p", "weight of the drained chamber's pressure error", at_least=0
    )
    weight_switching: float = quantity("m/s", "W_sw,e", "weight of one valve switch", at_least=0)
    k_x: float = quantity("1/s", "K_x", "position gain of its literature", above=0)


class FourChamber(_Switched):
    """A cylinder of four chambers, areas 8:4:2:1, between two lines: secondary control."""

    smallest_area: float = quantity("m^2", "A_1", "area of the smallest chamber", above=0)
    dead_volume: float = quantity("m^3", "V_0", "dead volume of each chamber", above=0)
    low_pressure: float = quantity("Pa", "p_LP", "pressure of the low line", at_least=0)
    high_pressure: float = quantity("Pa", "p_HP", "pressure of the high line", above=0)
    flow_coefficient: float = quantity(
        "m^3/(s Pa^0.5)",
        "K_v,8",
        "flow coefficient of the largest chamber's valves, the others' in proportion",
        above=0,
    )
    least_flow_coefficient: float = quantity(
        "m^3/(s Pa^0.5)", "K_v,min", "least flow coefficient of a valve", above=0
    )
    weight_compression: float = quantity(
        "N/J", "W_comp", "weight of the energy that a change of pressures costs", at_least=0
    )
    weight_switching: float = quantity("N", "W_sw", "weight of one valve switch", at_least=0)
    k_p_vel: float = quantity("N s/m", "K_P,vel", "velocity gain of its literature", above=0)
    k_p_pos: float = quantity("1/s", "K_P,pos", "position gain of its literature", above=0)
    k_i_pos: float = quantity("1/s^2", "K_I,pos", "integral gain of its literature", at_least=0)

    @model_validator(mode="after")
    def _pressures_are_ordered(self) -> Self:
        if not self.low_pressure < self.high_pressure:
            refuse("has a low_pressure not below its high_pressure", "check both pressures")
        return self


class PidLoop(Section):
    """Position control by PID with a filter, around the velocity gain (refs. 5 and 6)."""

    k_p_vel: float = quantity("N s/m", "K_P,vel", "velocity gain", above=0)
    k_p: float = quantity("1/s", "K_P", "position gain", above=0)
    k_i: float = quantity("1/s^2", "K_I", "integral gain", at_least=0)
    derivative_time: float = quantity("s", "T_D", "derivative time", at_least=0)
    filter_time: float = quantity("s", "τ", "time constant of the filter", above=0)


class CascadeLoop(Section):
    """Position control by P around velocity control by PI (refs. 5 and 6)."""

    k_p: float = quantity("N s/m", "K_P", "velocity gain", above=0)
    k_i: float = quantity("N/m", "K_I", "integral gain of the velocity loop", at_least=0)
    k_x: float = quantity("1/s", "K_x", "position gain", above=0)


class Systems(Section):
    """What is compared under the study's load and moves, and by which rule."""

    repeats: int = quantity("1", "n", "movement sets per run, the first left out", 5, at_least=2)
    gain_margin: float = quantity(
        "1", "g", "factor on the loop gain at which a best controller must still be stable", 1.5,
        at_least=1,
    )  # fmt: skip
    load_sensing: LoadSensing | None = Field(None, description="with a proportional valve")
    digital_valves: DigitalValves | None = Field(None, description="with digital valves")
    four_chamber: FourChamber | None = Field(None, description="a four-chamber cylinder")
    pid_loop: PidLoop | None = Field(None, description="this machine under PID")
    cascade_loop: CascadeLoop | None = Field(None, description="this machine under P and PI")
