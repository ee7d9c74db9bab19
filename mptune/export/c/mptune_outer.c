/* The outer loops at T_S: Eq. 22 under Tustin, the velocity loop of Eq. 18, the stop logic. */
#include "mptune_parts.h"

uint8_t mptune_outer_loops(mptune_state *state, const mptune_inputs *inputs, mptune_real velocity)
{
    const mptune_parameters *const p = &mptune_study;
    const mptune_real error = state->reference - mptune_position(state);
    const mptune_real shaped = p->b0 * error + state->lag_1; /* Eq. 22, second-order section */
    state->lag_1 = p->b1 * error - p->a1 * shaped + state->lag_2;
    state->lag_2 = p->b2 * error - p->a2 * shaped;

    mptune_real gained = p->integral_rate * (error + state->last_error); /* Eq. 22, integral term */
    if (MPTUNE_ABS(error) < p->dead_zone) {
        gained = R(0);
    }
    state->last_error = error;

    const mptune_real wanted = state->velocity_reference + shaped + state->integral - velocity;
    mptune_real force = p->k_p_vel * (wanted + gained)
                        + mptune_fed_mass(state) * inputs->acceleration_reference; /* Eq. 18 */
    force += mptune_friction_ahead(state->velocity_reference);
    const uint8_t winding_up = (force > p->force_largest) && (gained > R(0));
    const uint8_t winding_down = (force < p->force_least) && (gained < R(0));
    if ((winding_up == 0U) && (winding_down == 0U)) {
        state->integral += gained;
    }
    state->force = mptune_min(mptune_max(force, p->force_least), p->force_largest);
    return mptune_within(force, -MPTUNE_BEYOND, MPTUNE_BEYOND);
}

void mptune_stop_logic(mptune_state *state, const mptune_inputs *inputs)
{
    const mptune_parameters *const p = &mptune_study;
    const mptune_real error = MPTUNE_ABS(inputs->position_reference - mptune_position(state));
    const mptune_real tolerance = (state->stopped != 0U) ? p->start_tolerance : p->stop_tolerance;
    const uint8_t still = MPTUNE_ABS(inputs->velocity_reference) <= p->velocity_tolerance;
    state->stopped = ((still != 0U) && (error <= tolerance)) ? 1U : 0U; /* Eq. 9 and 10 */
}
