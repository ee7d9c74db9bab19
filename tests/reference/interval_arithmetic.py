"""Every certified figure over a box by interval arithmetic, with mpmath alone.

An independent route to what ``mptune.certify`` encloses, and it imports nothing of it: equations
are written as the paper prints them (Eq. 11 with its denominators restored), transfer function by
transfer function, on rectangular complex intervals of mpmath's ``iv``, whose elementary functions
are rounded outwards. Nothing is cleverly rearranged: the enclosures are therefore wider than they
need be, and hold without any argument of ours.

A box is a dictionary of pairs: ``omega`` [rad/s], ``mass_ratio`` (m_N/m), ``delay``, ``tau_a``,
``tau_b`` [s]. A loop is a dictionary of numbers: ``k_p_vel``, ``k_p_pos``, ``k_i_pos``,
``corner``, ``xi``, ``tau``, ``share_a``, ``nominal_mass``, ``nominal_delay``, with a measurement
path ``sample`` and ``pole``, and sampled ``period`` as well.
"""

from __future__ import annotations

from mpmath import iv, mp

iv.prec = 80
mp.prec = 80


def interval(pair):
    """Return a pair of numbers as an interval."""
    return iv.mpf([pair[0], pair[1]])


def plant_values(box, loop):
    """Return mass, delay and time constants of a box's plants."""
    mass = iv.mpf(loop["nominal_mass"]) / interval(box["mass_ratio"])
    return [mass, *(interval(box[key]) for key in ("delay", "tau_a", "tau_b"))]


def turning(angle):
    """Return e^{−jx} over an interval of x."""
    return iv.mpc(iv.cos(angle), -iv.sin(angle))


def imaginary(value):
    """Return jx."""
    return iv.mpc(iv.mpf(0), value)


def plant(omega, mass, delay, tau_a, tau_b, loop):
    """Return s·G_vel of Eq. 15, without its integrator."""
    share = iv.mpf(loop["share_a"])
    s = imaginary(omega)
    lead = share * tau_b + (1 - share) * tau_a
    force = (lead * s + 1) / ((tau_a * s + 1) * (tau_b * s + 1))  # Eq. 11
    return force * turning(omega * delay) / mass


def path(omega, loop):
    """Return the responses from position to filtered position and from velocity to Eq. 23's."""
    if not loop.get("sample"):
        return iv.mpc(1, 0), iv.mpc(1, 0)
    sample, pole = iv.mpf(loop["sample"]), iv.mpf(loop["pole"])
    tick = turning(omega * sample)
    place = (1 - pole) * tick / (1 - pole * tick)  # filter behind a median of one sample
    taps = 5 + 3 * tick + tick**2 - tick**3 - 3 * tick**4 - 5 * tick**5
    return place, place * taps / (35 * sample) / imaginary(omega)  # Eq. 23


def controller(omega, loop):
    """Return Eq. 22."""
    s, corner = imaginary(omega), iv.mpf(loop["corner"])
    shape = (s * s / corner**2 + 2 * iv.mpf(loop["xi"]) * s / corner + 1) / (
        iv.mpf(loop["tau"]) * s + 1
    ) ** 2
    return iv.mpf(loop["k_p_pos"]) * shape + iv.mpf(loop["k_i_pos"]) / s


def loop_gains(omega, values, loop):
    """Return the loop gains of the velocity loop and of the whole, broken at F_ref."""
    place, speed = path(omega, loop)
    velocity = iv.mpf(loop["k_p_vel"]) * plant(omega, *values, loop) / imaginary(omega)
    return velocity * speed, velocity * (speed + controller(omega, loop) * place / imaginary(omega))


def modulus(value):
    """Return |z| over a rectangle."""
    return iv.sqrt(value.real**2 + value.imag**2)


def equations(box, loop):
    """Return the left over the right sides of Eq. 17 and Eq. 21, as intervals."""
    omega = interval(box["omega"])
    values = plant_values(box, loop)
    nothing = iv.mpf(0)
    nominal = [iv.mpf(loop["nominal_mass"]), iv.mpf(loop["nominal_delay"]), nothing, nothing]
    true_v, _ = loop_gains(omega, values, loop)
    nominal_v, nominal_f = loop_gains(omega, nominal, loop)
    error = (true_v - nominal_v) / nominal_v  # Eq. 16
    ratio_17 = modulus(error * nominal_v / (1 + nominal_v))  # Eq. 17
    position = (nominal_f - nominal_v) / (1 + nominal_v)  # the nominal position loop's gain
    error_position = error / (1 + true_v)  # Eq. 20
    return ratio_17, modulus(error_position * position / (1 + position))  # Eq. 21


def peaks(box, loop, which):
    """Return |S|, |T| and |S − T|/2 of the velocity, position or force loop, as intervals."""
    omega = interval(box["omega"])
    values = plant_values(box, loop)
    velocity, force = loop_gains(omega, values, loop)
    gain = {"velocity": velocity, "force": force, "position": (force - velocity) / (1 + velocity)}
    return of_loop(gain[which])


def of_loop(gain):
    """Return |S|, |T| and |S − T|/2 of a loop gain."""
    return (
        modulus(1 / (1 + gain)),
        modulus(gain / (1 + gain)),
        modulus((1 - gain) / (1 + gain)) / 2,
    )


def sampled_gain(box, loop, terms):
    """Return the loop gain at F_ref as it runs, from its aliases up to ±``terms``."""
    omega, period = interval(box["omega"]), iv.mpf(loop["period"])
    values = plant_values(box, loop)
    values[1] = values[1] - period / 2  # the hold is explicit here
    law = tustin(omega, loop)
    total = iv.mpc(0, 0)
    for k in range(-terms, terms + 1):
        at = omega + 2 * iv.pi * k / period
        place, speed = path(at, loop)
        s = imaginary(at)
        held = (1 - turning(at * period)) / (s * period)
        moved = iv.mpf(loop["k_p_vel"]) * held * plant(at, *values, loop) / (s * s)
        total += moved * (speed * s + law * place)
    return total


def tustin(omega, loop):
    """Return Eq. 22 with s replaced by (2/T_S)(z − 1)/(z + 1)."""
    period, corner = iv.mpf(loop["period"]), iv.mpf(loop["corner"])
    w = turning(omega * period)
    s = 2 / period * (1 - w) / (1 + w)
    shape = (s * s / corner**2 + 2 * iv.mpf(loop["xi"]) * s / corner + 1) / (
        iv.mpf(loop["tau"]) * s + 1
    ) ** 2
    return iv.mpf(loop["k_p_pos"]) * shape + iv.mpf(loop["k_i_pos"]) / s


def figure(box, loop, name, terms):
    """Return a figure over a box, loop, path and figure named as the certificates name them.

    The pair of numbers is rounded outwards by a few units in the last place of a float.
    """
    where, path_name, which = name
    loop = dict(loop) if path_name != "none" else {**loop, "sample": 0}
    if which.startswith("equation"):
        found = equations(box, loop)[0 if which == "equation_17" else 1]
    elif which == "peak_compliance":  # |S|/(mω²), in m/N
        omega, mass = (
            interval(box["omega"]),
            iv.mpf(loop["nominal_mass"]) / interval(box["mass_ratio"]),
        )
        sampled = path_name == "sampled"
        gain = (
            sampled_gain(box, loop, terms)
            if sampled
            else (loop_gains(omega, plant_values(box, loop), loop)[1])
        )
        found = modulus(1 / (1 + gain)) / (mass * omega**2)
    else:
        index = ("sensitivity_peak", "complementary_peak", "disk_margin").index(which)
        if path_name == "sampled":
            found = of_loop(sampled_gain(box, loop, terms))[index]
        else:
            found = peaks(box, loop, "force" if where == "force_reference" else where)[index]
    low, high = float(found.a), float(found.b)
    return low * (1 - 4e-16), high * (1 + 4e-16)
