/* The controller's variables by value reference, and communication steps of whole T_S,fast. */
#include "unit.h"

#define STEP_TOLERANCE 1e-6 /* of T_S,fast, how far a step may be from a whole number of it */
#define MOST_PERIODS 1e9    /* in one communication step */

static mptune_real *input_at(mptune_inputs *inputs, unsigned int reference)
{
    mptune_real *place = NULL;
    switch (reference) {
    case 0U: place = &inputs->position_reference; break;
    case 1U: place = &inputs->velocity_reference; break;
    case 2U: place = &inputs->acceleration_reference; break;
    case 3U: place = &inputs->position; break;
    case 4U: place = &inputs->pressure_a; break;
    case 5U: place = &inputs->pressure_b; break;
    case 6U: place = &inputs->pressure_high; break;
    case 7U: place = &inputs->pressure_low; break;
    default:
        if (reference < UNIT_FURTHER) {
            place = &inputs->converter[reference - UNIT_CONVERTER];
        } else if (reference < UNIT_LOAD_FORCE) {
            place = &inputs->further[reference - UNIT_FURTHER];
        }
        break;
    }
    return place;
}

int unit_get_real(const unit_memory *memory, unsigned int reference, double *value)
{
    mptune_inputs inputs = memory->inputs;
    const mptune_real *const place = input_at(&inputs, reference);
    if (place != NULL) {
        *value = (double)*place;
    } else if (reference == UNIT_LOAD_FORCE) {
        *value = (double)memory->load_force;
    } else if (reference == UNIT_FORCE_REFERENCE) {
        *value = (double)memory->outputs.force_reference;
    } else if (reference == UNIT_TIME) {
        *value = memory->time;
    } else {
        return 0;
    }
    return 1;
}

int unit_set_real(unit_memory *memory, unsigned int reference, double value)
{
    mptune_real *const place = input_at(&memory->inputs, reference);
    if (place != NULL) {
        *place = (mptune_real)value;
    } else if ((reference == UNIT_LOAD_FORCE) && (memory->running == 0)) {
        memory->load_force = (mptune_real)value;
    } else {
        return 0;
    }
    return 1;
}

int unit_get_integer(const unit_memory *memory, unsigned int reference, int *value)
{
    switch (reference) {
    case UNIT_STATE_A: *value = memory->outputs.state_a; break;
    case UNIT_STATE_B: *value = memory->outputs.state_b; break;
    case UNIT_FAULT: *value = (int)memory->outputs.fault; break;
    default:
        if ((reference <= UNIT_STATE_B) || (reference >= UNIT_FAULT)) {
            return 0;
        }
        *value = memory->outputs.state_further[reference - UNIT_STATE_B - 1U];
        break;
    }
    return 1;
}

int unit_get_boolean(const unit_memory *memory, unsigned int reference, int *value)
{
    if (reference == UNIT_STOPPED) {
        *value = memory->outputs.stopped;
    } else if (reference == UNIT_DECIDED) {
        *value = memory->outputs.decided;
    } else if ((reference >= UNIT_VALVE) && (reference < UNIT_TIME)) {
        *value = memory->outputs.valve[reference - UNIT_VALVE];
    } else {
        return 0;
    }
    return 1;
}

int unit_start(unit_memory *memory)
{
    memory->running = mptune_init(&memory->state, &memory->inputs, memory->load_force) == 0U;
    return memory->running;
}

int unit_step(unit_memory *memory, double step)
{
    const double period = (double)mptune_study.sample_time;
    const double periods = step / period;
    if ((memory->running == 0) || !(periods > 0.5) || !(periods < MOST_PERIODS)) {
        return 0;
    }
    const unsigned long whole = (unsigned long)(periods + 0.5);
    const double deviation = periods - (double)whole;
    if (!((deviation <= STEP_TOLERANCE) && (deviation >= -STEP_TOLERANCE))) {
        return 0;
    }
    for (unsigned long i = 0UL; i < whole; i++) { /* inputs are held; faults are an output */
        (void)mptune_step(&memory->state, &memory->inputs, &memory->outputs);
    }
    memory->time += step;
    return 1;
}

void unit_reset(unit_memory *memory)
{
    static const double start[UNIT_LOAD_FORCE + 1U] = UNIT_START;
    static const unit_memory blank = {0};
    *memory = blank;
    for (unsigned int i = 0U; i <= UNIT_LOAD_FORCE; i++) {
        (void)unit_set_real(memory, i, start[i]);
    }
}
