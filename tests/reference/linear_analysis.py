"""Evaluate Eq. 17 and Eq. 21 and the sensitivity peaks by brute force, with numpy alone.

Run it in this folder to write ``worst_ratios.csv`` and ``sensitivity.csv`` anew::

    python linear_analysis.py

It is an independent route to the figures of the package under test and imports nothing of it:
every equation is written out as printed in the paper (Eq. 11 with its denominators restored), on a
fixed grid, without refinement, interpolation or cleverness.
"""

from __future__ import annotations

import csv
from itertools import product
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
SHARE_A = 4 / 7  # A_A/(A_A + A_B) with A_B/A_A = 0.75

# Table 2
K_P_VEL, K_P_POS, K_I_POS, OMEGA, XI, TAU = 700e3, 13.0, 22.0, 42.0, 0.55, 0.006
SAMPLE = 0.0005  # T_S,fast
POSITION_FILTER = 0.012  # §5.2

TAU_A, TAU_B = (0.0001, 0.0122), (0.0001, 0.0119)
SETS = {  # masses, delays, nominal delay
    "fig-5": ((24500.0, 49000.0), (0.011, 0.0215), 0.011),
    "section-5-1": ((24500.0, 49000.0), (0.010, 0.014), 0.010),
}
PLANTS = (  # mass, delay, tau_a, tau_b
    (24500.0, 0.010, 0.0001, 0.0001),
    (24500.0, 0.014, 0.0122, 0.0119),
    (49000.0, 0.014, 0.0122, 0.0119),
    (24500.0, 0.0215, 0.0122, 0.0119),
)


def velocity_plant(s, mass, delay, tau_a=0.0, tau_b=0.0):
    """Return Eq. 15; Eq. 14 where both lags are zero."""
    lead = SHARE_A * tau_b + (1 - SHARE_A) * tau_a
    force = (lead * s + 1) / ((tau_a * s + 1) * (tau_b * s + 1))  # Eq. 11
    return force * np.exp(-s * delay) / (mass * s)


def position_controller(s):
    """Return Eq. 22."""
    shape = (s**2 / OMEGA**2 + 2 * XI * s / OMEGA + 1) / (TAU * s + 1) ** 2
    return K_P_POS * shape + K_I_POS / s


def worst_ratios():
    """Yield set, equation, worst left/right ratio, and the plant and frequency behind it."""
    s = 1j * np.geomspace(0.1, 1000, 4000)
    for name, (masses, delays, nominal_delay) in SETS.items():
        nominal = velocity_plant(s, masses[0], nominal_delay)
        nominal_position = nominal * K_P_VEL / (s * (1 + nominal * K_P_VEL))  # Eq. 19
        velocity_loop, position_loop = nominal * K_P_VEL, nominal_position * position_controller(s)
        right_17 = np.abs((1 + velocity_loop) / velocity_loop)
        right_21 = np.abs((1 + position_loop) / position_loop)
        best = {"17": (0.0, ()), "21": (0.0, ())}
        axes = (np.linspace(*pair, 7) for pair in (masses, delays, TAU_A, TAU_B))
        for plant in product(*axes):
            true = velocity_plant(s, *plant)
            true_position = true * K_P_VEL / (s * (1 + true * K_P_VEL))  # Eq. 19
            left_17 = np.abs((true - nominal) / nominal)  # Eq. 16
            left_21 = np.abs((true_position - nominal_position) / nominal_position)  # Eq. 20
            for equation, ratio in (("17", left_17 / right_17), ("21", left_21 / right_21)):
                top = int(np.argmax(ratio))
                if ratio[top] > best[equation][0]:
                    best[equation] = float(ratio[top]), (*map(float, plant), float(s[top].imag))
        for equation, (ratio, where) in best.items():
            yield name, equation, ratio, *where


def loops(s, plant, with_path):
    """Return the loop gains of the velocity loop and of the whole, broken at F_ref."""
    position = velocity = np.ones_like(s)
    if with_path:
        z = np.exp(s * SAMPLE)
        pole = np.exp(-SAMPLE / POSITION_FILTER)
        position = (1 - pole) / (1 - pole / z) / z  # filter behind a median of one sample
        taps = 5 + 3 / z + 1 / z**2 - 1 / z**3 - 3 / z**4 - 5 / z**5
        velocity = position * taps / (35 * SAMPLE) / s  # Eq. 23 over a perfect differentiator
    true = velocity_plant(s, *plant) * K_P_VEL
    return true * velocity, true * (velocity + position_controller(s) * position / s)


def right_half_plane_poles(s, loop, integrators):
    """Count closed-loop poles by the turns of 1 + L from near zero to far beyond the crossover."""
    difference = 1 + loop
    turned = np.angle(difference[1:] / difference[:-1]).sum() - integrators * np.pi / 2
    turned += np.angle(difference[0] * 1j**integrators) - np.angle(difference[-1])
    return round(float(-turned / np.pi))


def gain_margin(loop):
    """Return the least factor above 1 with which L meets −1, between points by a straight line."""
    cross = np.flatnonzero(np.diff(np.sign(loop.imag)))
    share = loop.imag[cross] / (loop.imag[cross] - loop.imag[cross + 1])
    real = loop.real[cross] + share * (loop.real[cross + 1] - loop.real[cross])
    factors = -1 / real[real < 0]
    return float(factors[factors > 1].min())


def sensitivity_peaks():
    """Yield plant, loop, path, unstable poles, M_S, its frequency and the gain margin."""
    s = 1j * np.geomspace(1e-3, 1e4, 400_000)
    for plant, with_path in product(PLANTS, (False, True)):
        found = loops(s, plant, with_path)
        for name, loop, integrators in zip(("velocity", "force"), found, (1, 3), strict=True):
            poles = right_half_plane_poles(s, loop, integrators)
            sensitivity = np.abs(1 / (1 + loop))
            top = int(np.argmax(sensitivity))
            figures = float(sensitivity[top]), float(s[top].imag), gain_margin(loop)
            path = "filters" if with_path else "none"
            yield *plant, name, path, poles, *(("", "", "") if poles else figures)


def write(name, header, rows):
    """Write a table with enough digits to be read back exactly."""
    with (HERE / name).open("w", newline="", encoding="utf-8") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(header)
        table.writerows(rows)


if __name__ == "__main__":
    plant_columns = ("mass_kg", "delay_s", "tau_a_s", "tau_b_s")
    write(
        "worst_ratios.csv",
        ("set", "equation", "worst_ratio", *plant_columns, "frequency_rad_s"),
        worst_ratios(),
    )
    write(
        "sensitivity.csv",
        (*plant_columns, "loop", "path", "unstable_poles", "m_s", "frequency_rad_s", "gain_margin"),
        sensitivity_peaks(),
    )
