"""The controller's fixed settings (Table 2, §5.2) and the gains of its outer loops."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from mptune.params.section import Section, quantity, refuse


class Controller(Section):
    """Sampling, filters, limits, tolerances and weights."""

    sampling_period: float = quantity("s", "T_S", "sampling period", above=0)
    fast_sampling_period: float = quantity(
        "s", "T_S,fast", "sampling period of acquisition and filters", above=0
    )
    position_filter: float = quantity("s", "τ_x", "time constant of the position filter", above=0)
    pressure_filter: float = quantity("s", "τ_p", "time constant, chamber pressures", above=0)
    supply_filter: float = quantity(
        "s", "τ_s", "time constant, supply pressures and converter pistons", above=0
    )
    converter_backlash: float = quantity("m", "b_conv", "converter backlash width", at_least=0)
    pressure_min: float = quantity("Pa", "p_min", "lowest allowed chamber pressure", at_least=0)
    pressure_max: float = quantity("Pa", "p_max", "highest allowed chamber pressure", above=0)
    dead_zone: float = quantity("m", "deadzone", "integrator dead zone", at_least=0)
    velocity_tolerance: float = quantity("m/s", "v_tol", "stopping tolerance", at_least=0)
    position_tolerance_stop: float = quantity("m", "x_tol1", "stopping tolerance", at_least=0)
    position_tolerance_start: float = quantity("m", "x_tol2", "starting tolerance", at_least=0)
    position_noise: float = quantity("m", "σ_x", "noise of the position sensor, rms", at_least=0)
    pressure_noise: float = quantity("Pa", "σ_p", "noise of a pressure sensor, rms", at_least=0)
    converter_noise: float = quantity("m", "σ_c", "noise of a converter sensor, rms", at_least=0)
    converter_flow: Literal["predicted", "present", "mean"] = Field(
        "predicted", description="pressures from which Eq. 7 takes Q_conv"
    )
    delay_prediction: float = quantity(
        "s", "d_p", "valve delay predicted through before deciding; 0 for none", 0.0, at_least=0
    )
    weight_switching: float = quantity("N", "W_sw", "weight of one valve switch", at_least=0)
    weight_loss: float = quantity("N/J", "W_loss", "weight of energy losses", at_least=0)
    weight_converter: float = quantity(
        "N s/m^6", "W_conv", "weight of converter piston positions", at_least=0
    )

    @model_validator(mode="after")
    def _periods_fit(self) -> Self:
        ticks = self.sampling_period / self.fast_sampling_period
        if ticks < 1 or abs(ticks - round(ticks)) > 1e-9 * ticks:
            refuse(
                f"has a sampling_period that is {ticks:g} times the fast_sampling_period",
                "make it a whole multiple",
            )
        return self

    @property
    def ticks(self) -> int:
        """Fast sampling periods in one sampling period."""
        return round(self.sampling_period / self.fast_sampling_period)


class Gains(Section):
    """The velocity gain (Eq. 18) and the five-parameter position controller (Eq. 22)."""

    k_p_vel: float = quantity("N s/m", "K_P,vel", "velocity controller gain", above=0)
    k_p_pos: float = quantity("1/s", "K_P,pos", "position controller gain, P-term", at_least=0)
    k_i_pos: float = quantity("1/s^2", "K_I,pos", "position controller gain, I-term", at_least=0)
    omega: float = quantity("rad/s", "ω", "tuning parameter of Eq. 22", above=0)
    xi: float = quantity("1", "ξ", "tuning parameter of Eq. 22", at_least=0)
    tau: float = quantity("s", "τ", "tuning parameter of Eq. 22", above=0)


class Feedforward(Section):
    """Feed-forward beyond the paper's velocity reference; all off in the paper's own study."""

    acceleration_mass: float = quantity(
        "kg", "m̂", "mass of the acceleration feed-forward", 0.0, at_least=0
    )
    reference_lag: float = quantity(
        "s", "τ_r", "lag of the position reference before comparison", 0.0, at_least=0
    )
    velocity_reference_lag: float = quantity(
        "s", "τ_v", "lag of the velocity reference", 0.0, at_least=0
    )
    preview: float = quantity(
        "s", "t_p", "how far ahead of the others the acceleration reference is fed", 0.0,
        at_least=0,
    )  # fmt: skip
    jerk: bool = Field(
        default=False,
        description="take the acceleration ahead from the jerk: the reference's future is unknown",
    )
    viscous_friction: float = quantity(
        "N s/m", "b̂", "viscous friction fed forward", 0.0, at_least=0
    )
    coulomb_friction: float = quantity("N", "F̂_C", "Coulomb friction fed forward", 0.0, at_least=0)
    friction_velocity: float = quantity(
        "m/s", "v̂_s", "velocity reference about which Coulomb friction turns over", 2e-3, above=0
    )
    adaptive_mass: bool = Field(
        default=False,
        description="learn the mass on line, within the family's; acceleration_mass is its start",
    )
