/* What hears the force at T_S,fast: the state estimator, and the mass that is learnt on line. */
#include "mptune_parts.h"

#define FORGETTING R(0.9999)      /* per T_S,fast: half is forgotten in 3.5 s of motion */
#define ACCELERATION_UNIT R(0.1)  /* m/s^2, of the first regressor */
#define VELOCITY_UNIT R(0.1)      /* m/s, of the second */
#define LEAST_VELOCITY R(0.002)   /* m/s: below it the reference counts as at rest */
#define MOST_ACCELERATION R(2)    /* m/s^2: beyond it the reference jumps */

/* Variances of the factors at the start, over that of the force that nothing explains. */
static const mptune_real first_covariance[MPTUNE_REGRESSORS] = {R(4), R(1), R(2.25), R(4)};

mptune_real mptune_fed_mass(const mptune_state *state)
{
    return (mptune_study.adaptive > R(0)) ? state->mass : mptune_study.acceleration_mass;
}

mptune_real mptune_friction_ahead(mptune_real velocity)
{
    const mptune_parameters *const p = &mptune_study;
    const mptune_real turn = p->friction_velocity;
    const mptune_real sign = velocity / MPTUNE_SQRT(velocity * velocity + turn * turn);
    return p->viscous_friction * velocity + p->coulomb_friction * sign;
}

void mptune_start_learning(mptune_state *state, mptune_real load)
{
    const mptune_parameters *const p = &mptune_study;
    state->mass = mptune_min(mptune_max(p->acceleration_mass, p->mass_least), p->mass_largest);
    state->factor[0] = state->mass * ACCELERATION_UNIT;
    state->factor[1] = p->viscous_friction * VELOCITY_UNIT;
    state->factor[2] = p->coulomb_friction;
    state->factor[3] = load;
    for (uint32_t i = 0U; i < MPTUNE_REGRESSORS; i++) {
        for (uint32_t j = 0U; j < MPTUNE_REGRESSORS; j++) {
            state->covariance[i][j] = (i == j) ? first_covariance[i] : R(0);
        }
    }
}

static void estimate(mptune_state *state, mptune_real position, mptune_real force, mptune_real rise)
{
    const mptune_parameters *const p = &mptune_study;
    const mptune_real time = p->sample_time;
    const mptune_real known =
        force + p->injected * ((p->estimator_mass - mptune_fed_mass(state)) * rise);
    const mptune_real acceleration = (known - state->heard_load) / p->estimator_mass;
    const mptune_real place =
        state->heard_position + time * (state->heard_velocity + R(0.5) * time * acceleration);
    const mptune_real error = position - place;
    state->heard_position = place + p->l_1 * error;
    state->heard_velocity = state->heard_velocity + time * acceleration + p->l_2 * error;
    state->heard_load = state->heard_load - p->estimator_mass * p->l_3 * error;
}

/* Recursive least squares: factors and covariance by one sample of the force. */
static void correct(
    mptune_state *state, const mptune_real regressor[MPTUNE_REGRESSORS], mptune_real force)
{
    mptune_real spread[MPTUNE_REGRESSORS];
    mptune_real error = force;
    const mptune_real forgetting =
        (state->covariance[0][0] < first_covariance[0]) ? FORGETTING : R(1);
    mptune_real scale = forgetting;
    for (uint32_t i = 0U; i < MPTUNE_REGRESSORS; i++) {
        mptune_real total = R(0);
        for (uint32_t j = 0U; j < MPTUNE_REGRESSORS; j++) {
            total += state->covariance[i][j] * regressor[j];
        }
        spread[i] = total;
        error -= state->factor[i] * regressor[i];
        scale += total * regressor[i];
    }
    for (uint32_t i = 0U; i < MPTUNE_REGRESSORS; i++) {
        const mptune_real gain = spread[i] / scale;
        state->factor[i] += gain * error;
        for (uint32_t j = 0U; j < MPTUNE_REGRESSORS; j++) {
            state->covariance[i][j] = (state->covariance[i][j] - gain * spread[j]) / forgetting;
        }
    }
}

static void learn(mptune_state *state, mptune_real force, mptune_real velocity, mptune_real rise)
{
    const mptune_parameters *const p = &mptune_study;
    const mptune_real fresh = R(1) - p->regressor_pole;
    state->lagged_velocity += fresh * (velocity - state->lagged_velocity);
    state->lagged_acceleration += fresh * (rise - state->lagged_acceleration);
    if ((MPTUNE_ABS(velocity) > LEAST_VELOCITY)
        && (MPTUNE_ABS(state->lagged_acceleration) <= MOST_ACCELERATION)) {
        const mptune_real speed = state->lagged_velocity;
        const mptune_real turn = p->friction_velocity;
        const mptune_real regressor[MPTUNE_REGRESSORS] = {
            state->lagged_acceleration / ACCELERATION_UNIT, speed / VELOCITY_UNIT,
            speed / MPTUNE_SQRT(speed * speed + turn * turn), R(1)};
        correct(state, regressor, force);
        state->mass = mptune_min(
            mptune_max(state->factor[0] / ACCELERATION_UNIT, p->mass_least), p->mass_largest);
    }
}

void mptune_know(
    mptune_state *state, const mptune_inputs *inputs, mptune_real position, mptune_real force)
{
    const mptune_real velocity = inputs->velocity_reference;
    const mptune_real rise =
        (velocity - state->last_velocity_reference) / mptune_study.sample_time; /* a_ref */
    if (mptune_study.estimator_mass > R(0)) {
        estimate(state, position, force, rise);
    }
    if (mptune_study.adaptive > R(0)) {
        learn(state, force, velocity, rise);
    }
    state->last_velocity_reference = velocity;
}
