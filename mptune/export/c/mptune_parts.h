/* The controller's parts: numbers, signals, outer loops, force controller. Not for callers. */
#ifndef MPTUNE_PARTS_H
#define MPTUNE_PARTS_H

#include "mptune_controller.h"

#if defined(__STDC_HOSTED__) && (__STDC_HOSTED__ == 1)
#include <math.h>
#else
float sqrtf(float value);
float fabsf(float value);
double sqrt(double value);
double fabs(double value);
#endif

#if MPTUNE_SINGLE_PRECISION
#define MPTUNE_SQRT sqrtf
#define MPTUNE_ABS fabsf
#else
#define MPTUNE_SQRT sqrt
#define MPTUNE_ABS fabs
#endif

#define R(value) ((mptune_real)(value))
#define MPTUNE_BEYOND R(1e30) /* larger than any number that means something here */

#define MPTUNE_POSITION 0U /* places of the sampled signals */
#define MPTUNE_CHAMBER_A 1U
#define MPTUNE_CHAMBER_B 2U
#define MPTUNE_HIGH 3U
#define MPTUNE_LOW 4U
#define MPTUNE_CONVERTER 5U
#define MPTUNE_FURTHER_CHAMBER (MPTUNE_CONVERTER + MPTUNE_CONVERTERS) /* and what follows it */

#define MPTUNE_STEPS 4U /* Heun steps in one look ahead */
#define MPTUNE_OUT_OF_RANGE R(1e6) /* N, fixed penalty of a pressure outside its limits */

#define MPTUNE_FIRST 0U /* of the chambers: A pushes, B pulls */
#define MPTUNE_SECOND 1U
#define MPTUNE_USUAL 2U /* chambers whose signals stand before the converters' */

/* What is the same for every valve state of one chamber. */
typedef struct {
    mptune_real pressure;                /* Pa, now */
    mptune_real taken;                   /* m^3/s, by the piston's motion */
    mptune_real path[MPTUNE_STEPS + 1U]; /* Pa/m^3, stiffness at the ends of the steps */
    mptune_real period;                  /* s, to look ahead */
    mptune_real scale;                   /* m^3/(s Pa^0.5), K_v of its valves */
} mptune_chamber;

/* What a decision starts from. */
typedef struct {
    mptune_real pressure_a; /* Pa */
    mptune_real pressure_b; /* Pa */
    mptune_real position;   /* m */
    mptune_real velocity;   /* m/s */
    mptune_real force;      /* N, F_ref */
} mptune_situation;

/* The lesser and the larger of two; the first where they are equal or not comparable. */
mptune_real mptune_min(mptune_real first, mptune_real second);
mptune_real mptune_max(mptune_real first, mptune_real second);
uint8_t mptune_within(mptune_real value, mptune_real least, mptune_real largest);

/* Signals: one T_S,fast. */
void mptune_lag_references(mptune_state *state, const mptune_inputs *inputs);
void mptune_measure(
    mptune_state *state, const mptune_real sample[MPTUNE_SIGNALS], mptune_real *position,
    mptune_real *force); /* the last two are of the medians */
mptune_real mptune_position(const mptune_state *state); /* m, filtered, or as estimated */
mptune_real mptune_velocity(const mptune_state *state); /* m/s, Eq. 23, or as estimated */

/* What hears the force: the state estimator and the mass that is learnt. One T_S,fast. */
void mptune_know(
    mptune_state *state, const mptune_inputs *inputs, mptune_real position, mptune_real force);
void mptune_start_learning(mptune_state *state, mptune_real load);
mptune_real mptune_fed_mass(const mptune_state *state);          /* kg */
mptune_real mptune_friction_ahead(mptune_real velocity);         /* N */

/* Outer loops: one T_S. The loops return 0 where they left the range of numbers. */
uint8_t mptune_outer_loops(mptune_state *state, const mptune_inputs *inputs, mptune_real velocity);
void mptune_stop_logic(mptune_state *state, const mptune_inputs *inputs);

/* Force controller: one T_S. It changes the choice, and returns 0 where no cost is a number. */
uint8_t mptune_decide(mptune_state *state, mptune_real velocity);

/* The penalty of a pressure outside its limits, N. */
mptune_real mptune_beyond_limits(mptune_real after);

/* The chamber whose pressure a signal is; MPTUNE_CHAMBERS for none. */
uint32_t mptune_chamber_of_signal(uint32_t signal);

/* Estimated B_eff over volume of one chamber, Pa/m^3. */
mptune_real mptune_stiffness(uint32_t chamber, mptune_real position);
mptune_chamber mptune_chamber_of(
    uint32_t chamber, mptune_real pressure, mptune_real position, mptune_real velocity,
    mptune_real period);

/* The pressure at the end of the look ahead with a valve state held, Pa. */
mptune_real mptune_predict(
    const mptune_chamber *one, const mptune_port *port, const mptune_real supplies[MPTUNE_LINES]);

/* Where the converter stands that makes a line, m; 0 where none does. */
mptune_real mptune_converter_place(uint32_t line, const mptune_real converters[MPTUNE_PLACES]);

/* The decision beyond the paper's own: as mptune_decide, from where the delay was predicted to. */
uint8_t mptune_best_ahead(
    const mptune_situation *now, const mptune_real supplies[MPTUNE_LINES],
    const mptune_real converters[MPTUNE_PLACES], mptune_choice choice[2]);

/* The same for more than two chambers, from the present pressures on. */
uint8_t mptune_decide_of_chambers(
    mptune_state *state, mptune_real velocity, const mptune_real supplies[MPTUNE_LINES]);

#endif
