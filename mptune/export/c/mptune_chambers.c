/* The decision for four chambers: a look ahead of each, and one combination step; two periods ahead,
 * another of each for the cheapest combinations. */
#include "mptune_rows.h"

#if MPTUNE_CHAMBERS > 2

#define PLACES ((MPTUNE_CANDIDATES < MPTUNE_STATES) ? MPTUNE_CANDIDATES : MPTUNE_STATES)
#define LIST (MPTUNE_CANDIDATES + 1U) /* one place more, to move the dearest out to */

/* One combination and what it costs, N. */
typedef struct {
    mptune_real cost;
    mptune_choice choice[MPTUNE_CHAMBERS];
} combination;

/* The signed force of a state, N. */
static mptune_real force_of(const mptune_row *row, uint32_t chamber, uint32_t i)
{
    return (mptune_chambers[chamber].pulls != 0U) ? -row->force[i] : row->force[i];
}

/* Eq. 7 of one combination, with Huber's count and the common-mode term. */
static mptune_real cost_of(
    mptune_real wanted, const mptune_row *const rows[MPTUNE_CHAMBERS], uint32_t a, uint32_t b, uint32_t c,
    uint32_t d)
{
    const mptune_real force_ab = force_of(rows[0], 0U, a) + force_of(rows[1], 1U, b);
    const mptune_real force_cd = force_of(rows[2], 2U, c) + force_of(rows[3], 3U, d);
    const mptune_real common_ab = rows[0]->common[a] + rows[1]->common[b];
    const mptune_real common = common_ab + (rows[2]->common[c] + rows[3]->common[d]);
    mptune_real total = mptune_counted(wanted - (force_ab + force_cd));
    total += R(0.5) * MPTUNE_ABS(common); /* a row's is half of its pressure's */
    return total + (rows[0]->cost[a] + rows[1]->cost[b] + (rows[2]->cost[c] + rows[3]->cost[d]));
}

/* Fill in the cheapest combinations, cheapest first and of equal ones the first; return how many. */
static uint32_t cheapest_of_four(
    mptune_real wanted, const mptune_row *const rows[MPTUNE_CHAMBERS], combination list[LIST])
{
    const mptune_real least = rows[2]->least + rows[3]->least;
    mptune_real worst = MPTUNE_BEYOND; /* of a full list, its dearest */
    uint32_t found = 0U; /* at most MPTUNE_CANDIDATES */
    for (uint32_t a = 0U; a < MPTUNE_STATES; a++) {
        for (uint32_t b = 0U; b < MPTUNE_STATES; b++) {
            if (rows[0]->cost[a] + rows[1]->cost[b] + least >= worst) {
                continue; /* a bound: force error and common mode cost nothing at least */
            }
            for (uint32_t c = 0U; c < MPTUNE_STATES; c++) {
                for (uint32_t d = 0U; d < MPTUNE_STATES; d++) {
                    const mptune_real total = cost_of(wanted, rows, a, b, c, d);
                    if (total < worst) {
                        uint32_t place = found;
                        for (; (place > 0U) && (total < list[place - 1U].cost); place--) {
                            list[place] = list[place - 1U];
                        }
                        list[place].cost = total;
                        list[place].choice[0] = (mptune_choice)a;
                        list[place].choice[1] = (mptune_choice)b;
                        list[place].choice[2] = (mptune_choice)c;
                        list[place].choice[3] = (mptune_choice)d;
                        found = (found < MPTUNE_CANDIDATES) ? (found + 1U) : found;
                        worst = (found == MPTUNE_CANDIDATES) ? list[found - 1U].cost : worst;
                    }
                }
            }
        }
    }
    return found;
}

/* The least cost of all; what with what went before reaches the best may be skipped. */
static mptune_real least_of_four(
    mptune_real wanted, const mptune_row *const rows[MPTUNE_CHAMBERS], mptune_real before,
    mptune_real best)
{
    const mptune_real least = rows[2]->least + rows[3]->least;
    mptune_real found = MPTUNE_BEYOND;
    for (uint32_t a = 0U; a < MPTUNE_STATES; a++) {
        for (uint32_t b = 0U; b < MPTUNE_STATES; b++) {
            const mptune_real bound = rows[0]->cost[a] + rows[1]->cost[b] + least;
            if ((bound >= found) || (before + bound >= best)) {
                continue;
            }
            for (uint32_t c = 0U; c < MPTUNE_STATES; c++) {
                for (uint32_t d = 0U; d < MPTUNE_STATES; d++) {
                    const mptune_real total = cost_of(wanted, rows, a, b, c, d);
                    if (total < found) {
                        found = total;
                    }
                }
            }
        }
    }
    return found;
}

/* Which of the cheapest combinations is so with the best of a second period, from a position on. */
static uint32_t best_ahead(
    const mptune_shared *all, mptune_real wanted, mptune_real position, mptune_real velocity,
    const mptune_row rows[MPTUNE_CHAMBERS], const combination list[LIST], uint32_t found)
{
    mptune_row met[MPTUNE_CHAMBERS * PLACES]; /* one for each state met in the second period */
    uint32_t where[MPTUNE_CHAMBERS][MPTUNE_STATES] = {{0U}}; /* counted from 1; 0 where not met */
    mptune_real best = MPTUNE_BEYOND;
    uint32_t number = 0U;
    uint32_t chosen = 0U;
    for (uint32_t k = 0U; k < found; k++) {
        const mptune_row *after[MPTUNE_CHAMBERS];
        for (uint32_t i = 0U; i < MPTUNE_CHAMBERS; i++) {
            const uint32_t one = list[k].choice[i];
            if (where[i][one] == 0U) {
                mptune_fill(all, i, rows[i].pressure[one], position, velocity, one, &met[number]);
                number++;
                where[i][one] = number;
            }
            after[i] = &met[where[i][one] - 1U];
        }
        const mptune_real total = list[k].cost + least_of_four(wanted, after, list[k].cost, best);
        if (total < best) {
            best = total;
            chosen = k;
        }
    }
    return chosen;
}

uint8_t mptune_decide_of_chambers(
    mptune_state *state, mptune_real velocity, const mptune_real supplies[MPTUNE_LINES])
{
    const mptune_real lag = mptune_study.delay_prediction;
    const mptune_real now = mptune_position(state);
    const mptune_shared all = mptune_shared_of(supplies, state->converters);
    mptune_row rows[MPTUNE_CHAMBERS];
    const mptune_row *const each[MPTUNE_CHAMBERS] = {&rows[0], &rows[1], &rows[2], &rows[3]};
    combination list[LIST];
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
    const uint32_t found = cheapest_of_four(state->force, each, list);
    uint32_t chosen = 0U;
    if (mptune_study.candidates > R(0)) {
        const mptune_real later = now + velocity * lag + velocity * mptune_study.sampling_period;
        chosen = best_ahead(&all, state->force, later, velocity, rows, list, found);
    }
    for (uint32_t i = 0U; (found > 0U) && (i < MPTUNE_CHAMBERS); i++) {
        state->choice[i] = list[chosen].choice[i];
    }
    return (found > 0U) ? 1U : 0U;
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
