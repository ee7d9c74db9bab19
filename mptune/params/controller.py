"""The controller's fixed settings (Table 2, §5.2) and the gains of its outer loops."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from mptune.params.section import Section, quantity, refuse


class Controller(Section):
    """Sampling, filters, limits, tolerances and weights."""

    sampling_period: float = quantity("s", "T_S", "sampling period", at_least=1e-4, at_most=1)
    fast_sampling_period: float = quantity(
        "s", "T_S,fast", "sampling period of acquisition and filters", at_least=1e-5, at_most=1
    )
    position_filter: float = quantity(
        "s", "τ_x", "time constant of the position filter", at_least=1e-6, at_most=10
    )
    pressure_filter: float = quantity(
        "s", "τ_p", "time constant, chamber pressures", at_least=1e-6, at_most=10
    )
    supply_filter: float = quantity(
        "s",
        "τ_s",
        "time constant, supply pressures and converter pistons",
        at_least=1e-6,
        at_most=10,
    )
    converter_backlash: float = quantity(
        "m", "b_conv", "converter backlash width", at_least=0, at_most=1
    )
    pressure_min: float = quantity(
        "Pa", "p_min", "lowest allowed chamber pressure", at_least=0, at_most=1e9
    )
    pressure_max: float = quantity(
        "Pa", "p_max", "highest allowed chamber pressure", at_least=1e3, at_most=1e9
    )
    dead_zone: float = quantity("m", "deadzone", "integrator dead zone", at_least=0, at_most=10)
    velocity_tolerance: float = quantity(
        "m/s", "v_tol", "stopping tolerance", at_least=0, at_most=10
    )
    position_tolerance_stop: float = quantity(
        "m", "x_tol1", "stopping tolerance", at_least=0, at_most=10
    )
    position_tolerance_start: float = quantity(
        "m", "x_tol2", "starting tolerance", at_least=0, at_most=10
    )
    position_noise: float = quantity(
        "m", "σ_x", "noise of the position sensor, rms", at_least=0, at_most=1
    )
    pressure_noise: float = quantity(
        "Pa", "σ_p", "noise of a pressure sensor, rms", at_least=0, at_most=1e8
    )
    converter_noise: float = quantity(
        "m", "σ_c", "noise of a converter sensor, rms", at_least=0, at_most=1
    )
    converter_flow: Literal["predicted", "present", "mean"] = Field(
        "predicted", description="pressures from which Eq. 7 takes Q_conv"
    )
    delay_prediction: float = quantity(
        "s",
        "d_p",
        "valve delay predicted through before deciding; 0 for none",
        0.0,
        at_least=0,
        at_most=1,
    )
    weight_switching: float = quantity(
        "N", "W_sw", "weight of one valve switch", at_least=0, at_most=1e12
    )
    weight_loss: float = quantity(
        "N/J", "W_loss", "weight of energy losses", at_least=0, at_most=1e12
    )
    weight_converter: float = quantity(
        "N s/m^6", "W_conv", "weight of converter piston positions", at_least=0, at_most=1e40
    )
    error: Literal["absolute", "huber"] = Field(
        "absolute",
        description="how Eq. 7 counts the force error: linearly, or squared where it is small",
    )
    error_width: float = quantity(
        "N",
        "f_0",
        "force error from which Huber's count is linear",
        2000.0,
        at_least=1e-3,
        at_most=1e9,
    )
    loss: Literal["ends", "path"] = Field(
        "ends", description="where Eq. 8 takes the losses: at both ends, or along Eq. 5's steps"
    )
    horizon: Literal[1, 2] = Field(1, description="sampling periods that a decision looks ahead")
    candidates: int = quantity(
        "1", "n", "combinations of which two periods are looked at", 6, at_least=1, at_most=784
    )
    weight_common_mode: float = quantity(
        "N/Pa",
        "W_cm",
        "weight of the mean pressure's way from mid-supply",
        0.0,
        at_least=0,
        at_most=1e12,
    )
    force_model: Literal["dynamic", "steady-state"] = Field(
        "dynamic", description="pressures that a state is judged by: after T_S, or once settled"
    )
    weight_compression: float = quantity(
        "N/J",
        "W_comp",
        "weight of compression energy, steady-state decision only",
        0.0,
        at_least=0,
        at_most=1e12,
    )

    weight_pressure: float = quantity(
        "N/Pa",
        "W_p",
        "weight of a pressure beyond its limits; 0 for the paper's fixed penalty",
        0.0,
        at_least=0,
        at_most=1e12,
    )
    max_combinations: int = quantity(
        "1", "n_max", "most combinations of both sides' states", 20_000, at_least=1, at_most=10**6
    )

    @model_validator(mode="after")
    def _compression_is_weighed(self) -> Self:
        if self.weight_compression > 0 and self.force_model == "dynamic":
            refuse(
                f"has a weight_compression of {self.weight_compression:g} N/J, which only the "
                "steady-state decision knows",
                'set it to "0 N/J", or force_model = "steady-state"',
            )
        return self

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

    k_p_vel: float = quantity(
        "N s/m", "K_P,vel", "velocity controller gain", at_least=1, at_most=1e12
    )
    k_p_pos: float = quantity(
        "1/s", "K_P,pos", "position controller gain, P-term", at_least=0, at_most=1e5
    )
    k_i_pos: float = quantity(
        "1/s^2", "K_I,pos", "position controller gain, I-term", at_least=0, at_most=1e9
    )
    omega: float = quantity("rad/s", "ω", "tuning parameter of Eq. 22", at_least=0.01, at_most=1e6)
    xi: float = quantity("1", "ξ", "tuning parameter of Eq. 22", at_least=0, at_most=1e3)
    tau: float = quantity("s", "τ", "tuning parameter of Eq. 22", at_least=1e-5, at_most=1)


class Feedforward(Section):
    """Feed-forward beyond the paper's velocity reference; all off in the paper's own study."""

    acceleration_mass: float = quantity(
        "kg", "m̂", "mass of the acceleration feed-forward", 0.0, at_least=0, at_most=1e8
    )
    reference_lag: float = quantity(
        "s", "τ_r", "lag of the position reference before comparison", 0.0, at_least=0, at_most=10
    )
    velocity_reference_lag: float = quantity(
        "s", "τ_v", "lag of the velocity reference", 0.0, at_least=0, at_most=10
    )
    preview: float = quantity(
        "s", "t_p", "how far ahead of the others the acceleration reference is fed", 0.0,
        at_least=0, at_most=10,
    )  # fmt: skip
    jerk: bool = Field(
        default=False,
        description="take the acceleration ahead from the jerk: the reference's future is unknown",
    )
    viscous_friction: float = quantity(
        "N s/m", "b̂", "viscous friction fed forward", 0.0, at_least=0, at_most=1e9
    )
    coulomb_friction: float = quantity(
        "N", "F̂_C", "Coulomb friction fed forward", 0.0, at_least=0, at_most=1e9
    )
    friction_velocity: float = quantity(
        "m/s",
        "v̂_s",
        "velocity reference about which Coulomb friction turns over",
        2e-3,
        at_least=1e-6,
        at_most=10,
    )
    adaptive_mass: bool = Field(
        default=False,
        description="learn the mass on line, within the family's; acceleration_mass is its start",
    )
