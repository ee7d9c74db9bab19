/* Conditioning of the measured signals at T_S,fast: median, filters, backlash, Eq. 23. */
#include "mptune_parts.h"

static const mptune_real taps[MPTUNE_TAPS] = {R(5), R(3), R(1), R(-1), R(-3), R(-5)}; /* Eq. 23 */

mptune_real mptune_min(mptune_real first, mptune_real second)
{
    return (second < first) ? second : first;
}

mptune_real mptune_max(mptune_real first, mptune_real second)
{
    return (second > first) ? second : first;
}

uint8_t mptune_within(mptune_real value, mptune_real least, mptune_real largest)
{
    return ((value >= least) && (value <= largest)) ? 1U : 0U; /* no number is within nothing */
}

static mptune_real median_of_three(mptune_real first, mptune_real second, mptune_real third)
{
    const mptune_real low = mptune_min(first, second);
    const mptune_real high = mptune_max(first, second);
    return mptune_max(low, mptune_min(high, third));
}

static mptune_real backlash(mptune_real held, mptune_real value, mptune_real width)
{
    const mptune_real half = R(0.5) * width;
    return mptune_min(mptune_max(held, value - half), value + half);
}

uint32_t mptune_chamber_of_signal(uint32_t signal)
{
    uint32_t chamber = MPTUNE_CHAMBERS;
    if ((signal == MPTUNE_CHAMBER_A) || (signal == MPTUNE_CHAMBER_B)) {
        chamber = signal - MPTUNE_CHAMBER_A;
    } else if (signal >= MPTUNE_FURTHER_CHAMBER) {
        chamber = signal - MPTUNE_FURTHER_CHAMBER + MPTUNE_USUAL;
    }
    return chamber;
}

static mptune_real pole_of(uint32_t signal)
{
    mptune_real pole = mptune_study.supply_pole;
    if (signal == MPTUNE_POSITION) {
        pole = mptune_study.position_pole;
    } else if (mptune_chamber_of_signal(signal) < MPTUNE_CHAMBERS) {
        pole = mptune_study.pressure_pole;
    }
    return pole;
}

void mptune_lag_references(mptune_state *state, const mptune_inputs *inputs)
{
    state->reference +=
        (R(1) - mptune_study.reference_pole) * (inputs->position_reference - state->reference);
    state->velocity_reference += (R(1) - mptune_study.velocity_reference_pole)
                                 * (inputs->velocity_reference - state->velocity_reference);
}

void mptune_measure(
    mptune_state *state, const mptune_real sample[MPTUNE_SIGNALS], mptune_real *position,
    mptune_real *force)
{
    for (uint32_t i = 0U; i < MPTUNE_SIGNALS; i++) {
        const mptune_real pole = pole_of(i);
        const mptune_real middle = median_of_three(sample[i], state->raw[0][i], state->raw[1][i]);
        state->raw[1][i] = state->raw[0][i];
        state->raw[0][i] = sample[i];
        state->filtered[i] = pole * state->filtered[i] + (R(1) - pole) * middle;
        const uint32_t chamber = mptune_chamber_of_signal(i);
        if (i == MPTUNE_POSITION) {
            *position = middle;
        } else if (chamber < MPTUNE_CHAMBERS) {
            const mptune_real own = mptune_chambers[chamber].area * middle;
            *force += (mptune_chambers[chamber].pulls != 0U) ? -own : own;
        }
    }
    for (uint32_t i = 0U; i != MPTUNE_CONVERTERS; i++) {
        state->converters[i] = backlash(
            state->converters[i], state->filtered[MPTUNE_CONVERTER + i], mptune_study.backlash);
    }
    for (uint32_t tap = MPTUNE_TAPS - 1U; tap > 0U; tap--) {
        state->history[tap] = state->history[tap - 1U];
    }
    state->history[0] = state->filtered[MPTUNE_POSITION];
}

mptune_real mptune_position(const mptune_state *state)
{
    return (mptune_study.estimator_mass > R(0)) ? state->heard_position : state->history[0];
}

mptune_real mptune_velocity(const mptune_state *state)
{
    mptune_real velocity = R(0);
    if (mptune_study.estimator_mass > R(0)) {
        return state->heard_velocity;
    }
    for (uint32_t tap = 0U; tap < MPTUNE_TAPS; tap++) {
        velocity += taps[tap] * state->history[tap];
    }
    return velocity / (R(35) * mptune_study.sample_time); /* Eq. 23 */
}
