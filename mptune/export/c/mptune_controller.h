/*
 * The controller of a multi-pressure hydraulic cylinder, as it runs on the target.
 *
 * mptune_init    once, before the first step, with a first set of samples.
 * mptune_step    every T_S,fast (mptune_study.sample_time, in s). It samples and filters at each
 *                call; at the first and at every MPTUNE_TICKS-th call after it, that is once per
 *                T_S, it also runs the outer loops, the stop logic and the force controller, whose
 *                choice among all chambers' valve states is then held.
 *
 * All values are in SI units. State lives in one mptune_state that the caller owns; the study's
 * numbers are constant data in mptune_parameters.c. Nothing is allocated, nothing recurses, every
 * loop is bounded, and of the mathematical library only sqrt and fabs are used.
 *
 * Compile without contraction of products and sums (-ffp-contract=off): in double precision the
 * valve commands are then those of mptune's own simulator, bit for bit.
 */
#ifndef MPTUNE_CONTROLLER_H
#define MPTUNE_CONTROLLER_H

#include <stdint.h>

#include "mptune_parameters.h"

#define MPTUNE_TAPS 6U       /* of the differentiating filter, Eq. 23 */
#define MPTUNE_REGRESSORS 4U /* of the mass that is learnt on line */

#ifdef __cplusplus
extern "C" {
#endif

/* Faults; mptune_init and mptune_step return their sum, 0 where there is none. All valves are shut
 * in a step with a fault, and stay shut until the next decision that is made without one. */
#define MPTUNE_FAULT_POINTER 1U /* a null pointer; nothing was written */
#define MPTUNE_FAULT_STATE 2U   /* the state was not set up by mptune_init, or was spoilt */
#define MPTUNE_FAULT_INPUT 4U   /* an input is no number, or outside the limits of mptune_study */
#define MPTUNE_FAULT_NUMERIC 8U /* the loops left the range of numbers; mptune_init is needed */

/* What the sensors say and what is asked for, at this T_S,fast. A step with any value that is no
 * number or outside the limits *_least and *_largest of mptune_study changes no filter. */
typedef struct {
    mptune_real position_reference;     /* m, x_ref */
    mptune_real velocity_reference;     /* m/s, v_ref */
    mptune_real acceleration_reference; /* m/s^2, a_ref for its feed-forward: mptune_study.preview
                                           ahead of the others where that is not 0, or with
                                           mptune_study.jerk a_ref + preview * j_ref of now */
    mptune_real position;               /* m, raw */
    mptune_real pressure_a;             /* Pa, raw, A-side chamber */
    mptune_real pressure_b;             /* Pa, raw, B-side chamber */
    mptune_real pressure_high;          /* Pa, raw, highest line */
    mptune_real pressure_low;           /* Pa, raw, lowest line */
    mptune_real converter[MPTUNE_PLACES]; /* m, raw, from the centre, positive on filling */
    mptune_real further[MPTUNE_FURTHER_PLACES]; /* Pa, raw, chambers behind A and B */
} mptune_inputs;

/* What is to be done until the next step. */
typedef struct {
    uint8_t valve[MPTUNE_CHAMBERS * MPTUNE_VALVES]; /* 1 open; chamber by chamber, A first, and
                                          line by line, lowest first */
    mptune_choice state_a;             /* below MPTUNE_STATES, row of mptune_valves */
    mptune_choice state_b;             /* the same */
    mptune_choice state_further[MPTUNE_FURTHER_PLACES]; /* of the chambers behind them */
    uint8_t stopped;                   /* 1 while the stop logic holds all valves shut */
    uint8_t decided;                   /* 1 in a step that ran the loops, once per T_S */
    uint32_t fault;                    /* sum of MPTUNE_FAULT_*, as returned */
    mptune_real force_reference;       /* N, F_ref, limited */
} mptune_outputs;

/* What the controller carries from step to step; set up by mptune_init, then left alone. */
typedef struct {
    mptune_real raw[2][MPTUNE_SIGNALS]; /* the last two samples */
    mptune_real filtered[MPTUNE_SIGNALS];
    mptune_real history[MPTUNE_TAPS]; /* m, filtered positions, newest first */
    mptune_real converters[MPTUNE_PLACES]; /* m, behind the backlash */
    mptune_real lag_1;                /* m/s, of the second-order section */
    mptune_real lag_2;                /* m/s */
    mptune_real integral;             /* m/s */
    mptune_real last_error;           /* m */
    mptune_real reference;            /* m, x_ref behind its lag */
    mptune_real velocity_reference;   /* m/s, v_ref behind its lag */
    mptune_real force;                /* N, F_ref */
    mptune_real heard_position;       /* m, of the state estimator, if there is one */
    mptune_real heard_velocity;       /* m/s */
    mptune_real heard_load;           /* N */
    mptune_real last_velocity_reference; /* m/s, v_ref of the step before */
    mptune_real mass;                 /* kg, learnt on line, if it is */
    mptune_real lagged_velocity;      /* m/s, v_ref behind the regression's lag */
    mptune_real lagged_acceleration;  /* m/s^2 */
    mptune_real factor[MPTUNE_REGRESSORS];
    mptune_real covariance[MPTUNE_REGRESSORS][MPTUNE_REGRESSORS];
    uint32_t ready;
    uint32_t tick; /* steps since the last decision */
    uint8_t stopped;
    mptune_choice choice[MPTUNE_CHAMBERS]; /* valve states, A's first */
} mptune_state;

/*
 * Set the controller up at rest: every filter stands at its sample, the valves are shut.
 *
 * first       the first samples and references.
 * load_force  N, the load at this place as far as it is known, else 0: the integrator carries it,
 *             where there is one.
 */
uint32_t mptune_init(mptune_state *state, const mptune_inputs *first, mptune_real load_force);

/* Run one T_S,fast. */
uint32_t mptune_step(mptune_state *state, const mptune_inputs *inputs, mptune_outputs *outputs);

#ifdef __cplusplus
}
#endif

#endif
