/* The decision for four chambers: a look ahead of each, and one combination step. */
#include "mptune_rows.h"

#if MPTUNE_CHAMBERS > 2

/* The signed force of a state, N. */
static mptune_real force_of(const mptune_row rows[MPTUNE_CHAMBERS], uint32_t chamber, uint32_t i)
{
    const mptune_real force = rows[chamber].force[i];
    return (mptune_chambers[chamber].pulls != 0U) ? -force : force;
}

/* Take the cheapest of all combinations, the first of several equal ones. */
static uint8_t cheapest_of_four(
    mptune_real wanted, const mptune_row rows[MPTUNE_CHAMBERS], mptune_choice choice[MPTUNE_CHAMBERS])
{
    const mptune_real least = rows[2].least + rows[3].least;
    mptune_real best = MPTUNE_BEYOND;
    uint8_t found = 0U;
    for (uint32_t a = 0U; a < MPTUNE_STATES; a++) {
        for (uint32_t b = 0U; b < MPTUNE_STATES; b++) {
            const mptune_real cost_ab = rows[0].cost[a] + rows[1].cost[b];
            if (cost_ab + least >= best) {
                continue; /* a bound: force error and common mode cost nothing at least */
            }
            const mptune_real force_ab = force_of(rows, 0U, a) + force_of(rows, 1U, b);
            const mptune_real common_ab = rows[0].common[a] + rows[1].common[b];
            for (uint32_t c = 0U; c < MPTUNE_STATES; c++) {
                for (uint32_t d = 0U; d < MPTUNE_STATES; d++) {
                    const mptune_real force_cd = force_of(rows, 2U, c) + force_of(rows, 3U, d);
                    const mptune_real common = common_ab + (rows[2].common[c] + rows[3].common[d]);
                    mptune_real total = mptune_counted(wanted - (force_ab + force_cd));
                    total += R(0.5) * MPTUNE_ABS(common); /* a row's is half of its pressure's */
                    total += cost_ab + (rows[2].cost[c] + rows[3].cost[d]); /* Eq. 7 */
                    if (total < best) {
                        best = total;
                        choice[0] = (mptune_choice)a;
                        choice[1] = (mptune_choice)b;
                        choice[2] = (mptune_choice)c;
                        choice[3] = (mptune_choice)d;
                        found = 1U;
                    }
                }
            }
        }
    }
    return found;
}

uint8_t mptune_decide_of_chambers(
    mptune_state *state, mptune_real velocity, const mptune_real supplies[MPTUNE_LINES])
{
    const mptune_real lag = mptune_study.delay_prediction;
    const mptune_real now = mptune_position(state);
    const mptune_shared all = mptune_shared_of(supplies, state->converters);
    mptune_row rows[MPTUNE_CHAMBERS];
    for (uint32_t i = 0U; i < MPTUNE_SIGNALS; i++) {
        const uint32_t chamber = mptune_chamber_of_signal(i);
        if (chamber < MPTUNE_CHAMBERS) {
            mptune_real pressure = state->filtered[i];
            if (lag > R(0)) { /* carried through the valve delay with the present state */
                const mptune_chamber one = mptune_chamber_of(chamber, pressure, now, velocity, lag);
                pressure = mptune_predict(&one, &mptune_ports[state->choice[chamber]], supplies);
            }
            mptune_fill(&all, chamber, pressure, now + velocity * lag, velocity,
                        state->choice[chamber], &rows[chamber]);
        }
    }
    return cheapest_of_four(state->force, rows, state->choice);
}

#else

uint8_t mptune_decide_of_chambers(
    mptune_state *state, mptune_real velocity, const mptune_real supplies[MPTUNE_LINES])
{
    (void)state; /* two chambers have their decision in mptune_force.c */
    (void)velocity;
    (void)supplies;
    return 0U;
}

#endif
