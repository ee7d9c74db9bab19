/* What the decisions beyond the paper's own are made of. Not for callers. */
#ifndef MPTUNE_ROWS_H
#define MPTUNE_ROWS_H

#include "mptune_parts.h"

/* One chamber's states, looked at from one pressure. */
typedef struct {
    mptune_real force[MPTUNE_STATES];    /* N */
    mptune_real cost[MPTUNE_STATES];     /* N, beside the force error */
    mptune_real common[MPTUNE_STATES];   /* N, half of the common-mode term, signed */
    mptune_real pressure[MPTUNE_STATES]; /* Pa, that it leads to */
    mptune_real least;                   /* N, of the costs */
} mptune_row;

/* What all rows of one decision share. */
typedef struct {
    const mptune_real *supplies;
    mptune_real cube[MPTUNE_LINES]; /* m^3, cubed converter positions; 0 without a converter */
    mptune_real middle;                /* Pa, mid-supply pressure */
    mptune_real steep;                 /* 3/(2 sqrt(p_tr)) */
    mptune_real bend;                  /* 1/(2 p_tr^1.5) */
} mptune_shared;

mptune_shared mptune_shared_of(
    const mptune_real supplies[MPTUNE_LINES], const mptune_real converters[MPTUNE_PLACES]);

/* Look at every state of one chamber from a pressure. */
void mptune_fill(
    const mptune_shared *all, uint32_t chamber, mptune_real pressure, mptune_real position,
    mptune_real velocity, uint32_t present, mptune_row *one);

/* Huber's count of a force error; linear throughout where no width is given. */
mptune_real mptune_counted(mptune_real error);

#endif
