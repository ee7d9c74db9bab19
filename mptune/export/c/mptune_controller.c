/* Set-up, checks of every input, and the order of the parts. */
#include "mptune_parts.h"

#define READY 0x6D70746EU /* a state that mptune_init has set up */

static uint8_t accepted(const mptune_inputs *inputs)
{
    const mptune_parameters *const p = &mptune_study;
    const mptune_real chambers_and_supplies[4] = {
        inputs->pressure_a, inputs->pressure_b, inputs->pressure_high, inputs->pressure_low};
    const mptune_real velocity = p->velocity_reference_largest;
    const mptune_real acceleration = p->acceleration_reference_largest;
    uint8_t good = mptune_within(inputs->position, p->position_least, p->position_largest);
    good &= mptune_within(inputs->position_reference, p->position_least, p->position_largest);
    good &= mptune_within(inputs->velocity_reference, -velocity, velocity);
    good &= mptune_within(inputs->acceleration_reference, -acceleration, acceleration);
    for (uint32_t i = 0U; i < 4U; i++) {
        good &= mptune_within(chambers_and_supplies[i], p->pressure_least, p->pressure_largest);
    }
    for (uint32_t i = 0U; i != MPTUNE_FURTHER; i++) {
        good &= mptune_within(inputs->further[i], p->pressure_least, p->pressure_largest);
    }
    for (uint32_t i = 0U; i != MPTUNE_CONVERTERS; i++) {
        good &= mptune_within(inputs->converter[i], -p->converter_largest, p->converter_largest);
    }
    return good;
}

static void samples_of(const mptune_inputs *inputs, mptune_real sample[MPTUNE_SIGNALS])
{
    sample[MPTUNE_POSITION] = inputs->position;
    sample[MPTUNE_CHAMBER_A] = inputs->pressure_a;
    sample[MPTUNE_CHAMBER_B] = inputs->pressure_b;
    sample[MPTUNE_HIGH] = inputs->pressure_high;
    sample[MPTUNE_LOW] = inputs->pressure_low;
    for (uint32_t i = 0U; i != MPTUNE_CONVERTERS; i++) {
        sample[MPTUNE_CONVERTER + i] = inputs->converter[i];
    }
    for (uint32_t i = 0U; i != MPTUNE_FURTHER; i++) {
        sample[MPTUNE_FURTHER_CHAMBER + i] = inputs->further[i];
    }
}

static void shut(mptune_state *state)
{
    for (uint32_t i = 0U; i < MPTUNE_CHAMBERS; i++) {
        state->choice[i] = 0U;
    }
}

static uint8_t spoilt(const mptune_state *state)
{
    uint8_t bad = (state->ready != READY) || (state->tick >= MPTUNE_TICKS);
    for (uint32_t i = 0U; i < MPTUNE_CHAMBERS; i++) {
        bad |= state->choice[i] >= MPTUNE_STATES;
    }
    return bad;
}

/* The loops and the force controller, once per T_S. */
static uint32_t control(mptune_state *state, const mptune_inputs *inputs)
{
    const mptune_real velocity = mptune_velocity(state);
    uint8_t sound = mptune_outer_loops(state, inputs, velocity);
    mptune_stop_logic(state, inputs);
    if (state->stopped != 0U) {
        shut(state);
    } else {
        sound &= mptune_decide(state, velocity);
    }
    return (sound != 0U) ? 0U : MPTUNE_FAULT_NUMERIC;
}

static void write_outputs(
    const mptune_state *state, uint8_t decided, uint32_t fault, mptune_outputs *outputs)
{
    for (uint32_t chamber = 0U; chamber < MPTUNE_CHAMBERS; chamber++) {
        for (uint32_t i = 0U; i < MPTUNE_VALVES; i++) {
            outputs->valve[MPTUNE_VALVES * chamber + i] = mptune_valves[state->choice[chamber]][i];
        }
    }
    for (uint32_t i = 0U; i != MPTUNE_FURTHER; i++) {
        outputs->state_further[i] = state->choice[MPTUNE_USUAL + i];
    }
    outputs->state_a = state->choice[0];
    outputs->state_b = state->choice[1];
    outputs->stopped = state->stopped;
    outputs->decided = decided;
    outputs->fault = fault;
    outputs->force_reference = state->force;
}

uint32_t mptune_init(mptune_state *state, const mptune_inputs *first, mptune_real load_force)
{
    static const mptune_state blank = {0};
    if ((state == 0) || (first == 0)) {
        return MPTUNE_FAULT_POINTER;
    }
    *state = blank;
    const mptune_parameters *const p = &mptune_study;
    if ((accepted(first) == 0U)
        || (mptune_within(load_force, p->force_least, p->force_largest) == 0U)) {
        return MPTUNE_FAULT_INPUT;
    }
    samples_of(first, state->filtered);
    samples_of(first, state->raw[0]);
    samples_of(first, state->raw[1]);
    for (uint32_t tap = 0U; tap < MPTUNE_TAPS; tap++) {
        state->history[tap] = first->position;
    }
    for (uint32_t i = 0U; i != MPTUNE_CONVERTERS; i++) {
        state->converters[i] = first->converter[i];
    }
    state->reference = first->position_reference;
    state->velocity_reference = first->velocity_reference;
    if (p->integral_rate > R(0)) { /* else there is no integral, and the load moves the piston */
        state->integral = load_force / p->k_p_vel;
    }
    state->heard_position = first->position;
    for (uint32_t i = 0U; i < MPTUNE_SIGNALS; i++) {
        const uint32_t chamber = mptune_chamber_of_signal(i);
        if (chamber < MPTUNE_CHAMBERS) {
            const mptune_real own = mptune_chambers[chamber].area * state->filtered[i];
            state->heard_load += (mptune_chambers[chamber].pulls != 0U) ? -own : own;
        }
    }
    state->last_velocity_reference = first->velocity_reference;
    mptune_start_learning(state, load_force);
    state->ready = READY;
    return 0U;
}

uint32_t mptune_step(mptune_state *state, const mptune_inputs *inputs, mptune_outputs *outputs)
{
    uint32_t fault = 0U;
    uint8_t decided = 0U;
    if ((state == 0) || (inputs == 0) || (outputs == 0)) {
        return MPTUNE_FAULT_POINTER;
    }
    if (spoilt(state) != 0U) {
        fault = MPTUNE_FAULT_STATE;
    } else if (accepted(inputs) == 0U) {
        fault = MPTUNE_FAULT_INPUT;
    } else {
        mptune_real sample[MPTUNE_SIGNALS];
        samples_of(inputs, sample);
        mptune_lag_references(state, inputs);
        mptune_real position = R(0);
        mptune_real force = R(0);
        mptune_measure(state, sample, &position, &force);
        mptune_know(state, inputs, position, force);
        if (state->tick == 0U) {
            fault = control(state, inputs);
            decided = 1U;
        }
    }
    if ((fault & (MPTUNE_FAULT_STATE | MPTUNE_FAULT_NUMERIC)) != 0U) {
        state->ready = 0U; /* until mptune_init */
        state->stopped = 0U;
        state->force = R(0);
    }
    if (fault != 0U) {
        shut(state);
    }
    state->tick = (state->tick + 1U < MPTUNE_TICKS) ? (state->tick + 1U) : 0U;
    write_outputs(state, decided, fault, outputs);
    return fault;
}
