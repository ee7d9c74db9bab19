/* One instance of the controller behind either version of the interface. */
#ifndef MPTUNE_UNIT_H
#define MPTUNE_UNIT_H

#include <stddef.h>

#include "mptune_controller.h"
#include "unit_token.h"

/* Value references, as in modelDescription.xml */
#define UNIT_CONVERTER 8U /* below it: the scalar members of mptune_inputs, in order */
#define UNIT_FURTHER (UNIT_CONVERTER + MPTUNE_CONVERTERS) /* chambers behind A and B */
#define UNIT_LOAD_FORCE (UNIT_FURTHER + MPTUNE_FURTHER)
#define UNIT_FORCE_REFERENCE (UNIT_LOAD_FORCE + 1U)
#define UNIT_STATE_A (UNIT_LOAD_FORCE + 2U)
#define UNIT_STATE_B (UNIT_LOAD_FORCE + 3U)
#define UNIT_FAULT (UNIT_STATE_A + MPTUNE_CHAMBERS)
#define UNIT_STOPPED (UNIT_FAULT + 1U)
#define UNIT_DECIDED (UNIT_FAULT + 2U)
#define UNIT_VALVE (UNIT_FAULT + 3U) /* to UNIT_TIME - 1: all valves, chamber A first */
#define UNIT_TIME (UNIT_VALVE + MPTUNE_CHAMBERS * MPTUNE_VALVES) /* the independent variable of FMI 3.0 */

/* All that changes: a copy of it is the state of the unit. */
typedef struct {
    mptune_state state;
    mptune_inputs inputs;
    mptune_outputs outputs;
    mptune_real load_force;
    double time;
    int running; /* 1 once initialized */
} unit_memory;

/* Each returns 1 where it could be done, else 0. */
int unit_get_real(const unit_memory *memory, unsigned int reference, double *value);
int unit_set_real(unit_memory *memory, unsigned int reference, double value);
int unit_get_integer(const unit_memory *memory, unsigned int reference, int *value);
int unit_get_boolean(const unit_memory *memory, unsigned int reference, int *value);
int unit_start(unit_memory *memory);
int unit_step(unit_memory *memory, double step);
void unit_reset(unit_memory *memory); /* to the start values of modelDescription.xml */

#endif
