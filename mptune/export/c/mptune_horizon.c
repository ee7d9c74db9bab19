/* The decision beyond the paper's own: Huber's count of the force error, losses along the path, a
 * common-mode term, two periods ahead, and settled pressures in place of those after T_S. The rows
 * of two periods take 1582 numbers on the stack for six candidates of 28 states. */
#include "mptune_rows.h"

#define SIDES 2U
#define PLACES ((MPTUNE_CANDIDATES < MPTUNE_STATES) ? MPTUNE_CANDIDATES : MPTUNE_STATES)
#define ROWS (SIDES * (1U + PLACES))
#define LIST (MPTUNE_CANDIDATES + 1U) /* one place more, to move the dearest out to */
#define HALVINGS 32U /* a bracket of some 10 MPa shrinks to some mPa */

/* The signed root of a pressure difference, Pa^0.5, smooth about zero, without a division. */
static mptune_real smooth_root(const mptune_shared *all, mptune_real difference)
{
    const mptune_real size = MPTUNE_ABS(difference);
    mptune_real root = difference * (all->steep - all->bend * size);
    if (size >= mptune_study.transition_pressure) {
        root = MPTUNE_SQRT(size); /* Eq. 2 */
        if (!(difference > R(0))) {
            root = -root;
        }
    }
    return root;
}

/* Pressure and cost of one state after T_S. */
static void look_ahead(
    const mptune_shared *all, const mptune_chamber *one, const mptune_port *port, mptune_real *pressure,
    mptune_real *cost)
{
    const mptune_parameters *const p = &mptune_study;
    const mptune_real scale = one->scale;
    const mptune_real step = one->period / R(MPTUNE_STEPS);
    const mptune_real high_1 = all->supplies[port->first];
    const mptune_real high_2 = all->supplies[port->second];
    const mptune_real n_1 = port->first_count;
    const mptune_real n_2 = port->second_count;
    const mptune_real start_1 = smooth_root(all, high_1 - one->pressure);
    const mptune_real start_2 = smooth_root(all, high_2 - one->pressure);
    mptune_real root_1 = start_1;
    mptune_real root_2 = start_2;
    mptune_real after = one->pressure;
    mptune_real lost = R(0);
    for (uint32_t k = 0U; k < MPTUNE_STEPS; k++) {
        const mptune_real flow_1 = n_1 * root_1;
        const mptune_real flow_2 = n_2 * root_2;
        const mptune_real slope_1 = one->path[k] * (scale * (flow_1 + flow_2) - one->taken);
        const mptune_real ahead = after + step * slope_1;
        mptune_real flow = n_1 * smooth_root(all, high_1 - ahead);
        flow += n_2 * smooth_root(all, high_2 - ahead);
        const mptune_real slope_2 = one->path[k + 1U] * (scale * flow - one->taken);
        const mptune_real then = after + R(0.5) * step * (slope_1 + slope_2); /* Eq. 5 */
        root_1 = smooth_root(all, high_1 - then);
        root_2 = smooth_root(all, high_2 - then);
        mptune_real power = flow_1 * (high_1 - after) + flow_2 * (high_2 - after);
        power += n_1 * root_1 * (high_1 - then) + n_2 * root_2 * (high_2 - then);
        lost += power;
        after = then;
    }
    const mptune_real now_1 = scale * n_1 * start_1;
    const mptune_real now_2 = scale * n_2 * start_2;
    const mptune_real then_1 = scale * n_1 * root_1;
    const mptune_real then_2 = scale * n_2 * root_2;
    mptune_real ends = now_1 * (high_1 - one->pressure) + then_1 * (high_1 - after);
    ends += now_2 * (high_2 - one->pressure) + then_2 * (high_2 - after);
    mptune_real loss = R(0.5) * one->period * ends; /* Eq. 8 */
    if (p->path_loss > R(0)) {
        loss = R(0.5) * step * (scale * lost); /* Eq. 8 over each of Eq. 5's steps */
    }
    const mptune_real share = p->predicted_share;
    const mptune_real drawn_1 = share * then_1 + (R(1) - share) * now_1;
    const mptune_real drawn_2 = share * then_2 + (R(1) - share) * now_2;
    const mptune_real conversion =
        -(drawn_1 * all->cube[port->first] + drawn_2 * all->cube[port->second]);
    *pressure = after;
    *cost = p->weight_loss * loss + p->weight_converter * conversion;
}

/* Pressure and cost of one state once settled: the flow is then what the piston takes. */
static void settle(
    const mptune_shared *all, const mptune_chamber *one, mptune_real stiff, const mptune_port *port,
    mptune_real *pressure, mptune_real *cost)
{
    const mptune_parameters *const p = &mptune_study;
    const mptune_real scale = one->scale;
    const mptune_real high_1 = all->supplies[port->first];
    const mptune_real high_2 = all->supplies[port->second];
    const mptune_real n_1 = port->first_count;
    const mptune_real n_2 = port->second_count;
    mptune_real settled = one->pressure; /* of a closed chamber */
    if (port->first_count > R(0)) {
        const mptune_real root = one->taken / (scale * (n_1 + n_2));
        const mptune_real reach = mptune_max(root * root, p->transition_pressure);
        const mptune_real other = (port->second_count > R(0)) ? high_2 : high_1;
        mptune_real low = mptune_min(high_1, other) - reach;
        mptune_real high = mptune_max(high_1, other) + reach;
        for (uint32_t k = 0U; k < HALVINGS; k++) {
            const mptune_real middle = R(0.5) * (low + high);
            mptune_real flow = n_1 * smooth_root(all, high_1 - middle);
            flow += n_2 * smooth_root(all, high_2 - middle);
            if (scale * flow > one->taken) {
                low = middle; /* the chamber still fills: it settles higher */
            } else {
                high = middle;
            }
        }
        settled = R(0.5) * (low + high);
    }
    const mptune_real flow_1 = scale * n_1 * smooth_root(all, high_1 - settled);
    const mptune_real flow_2 = scale * n_2 * smooth_root(all, high_2 - settled);
    const mptune_real loss =
        one->period * (flow_1 * (high_1 - settled) + flow_2 * (high_2 - settled)); /* Eq. 8 */
    const mptune_real conversion =
        -(flow_1 * all->cube[port->first] + flow_2 * all->cube[port->second]);
    const mptune_real change = settled - one->pressure;
    mptune_real total = p->weight_loss * loss + p->weight_converter * conversion;
    total += p->weight_compression * (R(0.5) * change * change / stiff);
    *pressure = settled;
    *cost = total;
}

void mptune_fill(
    const mptune_shared *all, uint32_t chamber, mptune_real pressure, mptune_real position,
    mptune_real velocity, uint32_t present, mptune_row *one)
{
    const mptune_parameters *const p = &mptune_study;
    const mptune_real area = mptune_chambers[chamber].area;
    const mptune_real half = R(0.5) * p->weight_common_mode;
    const uint8_t steady = (p->steady_state > R(0)) ? 1U : 0U;
    const mptune_chamber here =
        mptune_chamber_of(chamber, pressure, position, velocity, p->sampling_period);
    const mptune_real stiff = mptune_stiffness(chamber, position);
    one->least = MPTUNE_BEYOND;
    for (uint32_t i = 0U; i < MPTUNE_STATES; i++) {
        const mptune_port *const port = &mptune_ports[i];
        mptune_real after = R(0);
        mptune_real cost = R(0);
        if (steady != 0U) {
            settle(all, &here, stiff, port, &after, &cost);
        } else {
            look_ahead(all, &here, port, &after, &cost);
        }
        if ((steady != 0U) && (i == 0U) && (MPTUNE_ABS(velocity) > p->rest_velocity)) {
            cost = MPTUNE_BEYOND; /* a closed chamber settles at no pressure */
        }
        mptune_real total = p->weight_switching * R(mptune_switches[present][i]) + cost;
        if ((after < p->pressure_min) || (after > p->pressure_max)) {
            total += mptune_beyond_limits(after);
        }
        one->force[i] = area * after;
        one->cost[i] = total;
        one->common[i] = half * (after - all->middle);
        one->pressure[i] = after;
        if (total < one->least) {
            one->least = total;
        }
    }
}

mptune_real mptune_counted(mptune_real error)
{
    const mptune_real width = mptune_study.error_width;
    const mptune_real size = MPTUNE_ABS(error);
    mptune_real counted = size - R(0.5) * width;
    if (size < width) {
        counted = size * size * (R(0.5) / width);
    }
    return counted;
}

/* Eq. 7 of one pair, with Huber's count and the common-mode term. */
static mptune_real pair_cost(
    mptune_real wanted, const mptune_row *a, uint32_t i, const mptune_row *b, uint32_t j)
{
    const mptune_real counted = mptune_counted(wanted - (a->force[i] - b->force[j]));
    return counted + MPTUNE_ABS(a->common[i] + b->common[j]) + a->cost[i] + b->cost[j];
}

/* Fill in the cheapest pairs, cheapest first and of equal ones the first; return how many. */
static uint32_t cheapest_pairs(
    mptune_real wanted, const mptune_row *a, const mptune_row *b, mptune_real costs[LIST],
    uint32_t pairs[LIST])
{
    mptune_real worst = MPTUNE_BEYOND; /* of a full list, its dearest */
    uint32_t found = 0U; /* at most MPTUNE_CANDIDATES */
    for (uint32_t i = 0U; i < MPTUNE_STATES; i++) {
        if (a->cost[i] + b->least >= worst) {
            continue; /* no pair of this state can enter */
        }
        for (uint32_t j = 0U; j < MPTUNE_STATES; j++) {
            const mptune_real total = pair_cost(wanted, a, i, b, j);
            if (total < worst) {
                uint32_t place = found;
                for (; (place > 0U) && (total < costs[place - 1U]); place--) {
                    costs[place] = costs[place - 1U];
                    pairs[place] = pairs[place - 1U];
                }
                costs[place] = total;
                pairs[place] = MPTUNE_STATES * i + j;
                found = (found < MPTUNE_CANDIDATES) ? (found + 1U) : found;
                worst = (found == MPTUNE_CANDIDATES) ? costs[found - 1U] : worst;
            }
        }
    }
    return found;
}

/* The least cost of all pairs; pairs that with what went before reach the best may be skipped. */
static mptune_real least_pair(
    mptune_real wanted, const mptune_row *a, const mptune_row *b, mptune_real before, mptune_real best)
{
    mptune_real least = MPTUNE_BEYOND;
    for (uint32_t i = 0U; i < MPTUNE_STATES; i++) {
        const mptune_real bound = a->cost[i] + b->least;
        if ((bound >= least) || (before + bound >= best)) {
            continue;
        }
        for (uint32_t j = 0U; j < MPTUNE_STATES; j++) {
            const mptune_real total = pair_cost(wanted, a, i, b, j);
            if (total < least) {
                least = total;
            }
        }
    }
    return least;
}

mptune_shared mptune_shared_of(
    const mptune_real supplies[MPTUNE_LINES], const mptune_real converters[MPTUNE_PLACES])
{
    const mptune_real tr = mptune_study.transition_pressure;
    mptune_shared all;
    all.supplies = supplies;
    for (uint32_t i = 0U; i < MPTUNE_LINES; i++) {
        const mptune_real place = mptune_converter_place(i, converters);
        all.cube[i] = place * (place * place);
    }
    all.middle = R(0.5) * (supplies[0] + supplies[MPTUNE_LINES - 1U]);
    all.steep = R(1.5) / MPTUNE_SQRT(tr);
    all.bend = R(0.5) / (tr * MPTUNE_SQRT(tr));
    return all;
}

uint8_t mptune_best_ahead(
    const mptune_situation *now, const mptune_real supplies[MPTUNE_LINES],
    const mptune_real converters[MPTUNE_PLACES], mptune_choice choice[2])
{
    const mptune_parameters *const p = &mptune_study;
    const mptune_shared all = mptune_shared_of(supplies, converters);
    mptune_row rows[ROWS]; /* both sides now, then one for each state met in the second period */
    mptune_real costs[LIST];
    uint32_t pairs[LIST] = {0U};
    uint32_t where[SIDES][MPTUNE_STATES] = {{0U}}; /* 0 where not met: mptune_row 0 is none of these */
    mptune_fill(&all, MPTUNE_FIRST, now->pressure_a, now->position, now->velocity, choice[0], &rows[0]);
    mptune_fill(&all, MPTUNE_SECOND, now->pressure_b, now->position, now->velocity, choice[1], &rows[1]);
    const uint32_t found = cheapest_pairs(now->force, &rows[0], &rows[1], costs, pairs);
    uint32_t chosen = pairs[0];
    if (p->candidates > R(0)) {
        const mptune_real position = now->position + now->velocity * p->sampling_period;
        mptune_real best = MPTUNE_BEYOND;
        uint32_t met = SIDES;
        for (uint32_t k = 0U; k < found; k++) {
            const uint32_t states[SIDES] = {pairs[k] / MPTUNE_STATES, pairs[k] % MPTUNE_STATES};
            for (uint32_t side = 0U; side < SIDES; side++) {
                const uint32_t one = states[side];
                if (where[side][one] == 0U) {
                    mptune_fill(&all, side, rows[side].pressure[one], position, now->velocity, one,
                         &rows[met]);
                    where[side][one] = met;
                    met++;
                }
            }
            const mptune_row *const a = &rows[where[MPTUNE_FIRST][states[0]]];
            const mptune_row *const b = &rows[where[MPTUNE_SECOND][states[1]]];
            if (costs[k] + (a->least + b->least) >= best) {
                continue; /* a bound; the first period alone would be none */
            }
            const mptune_real total = costs[k] + least_pair(now->force, a, b, costs[k], best);
            if (total < best) {
                best = total;
                chosen = pairs[k];
            }
        }
    }
    choice[0] = (mptune_choice)(chosen / MPTUNE_STATES);
    choice[1] = (mptune_choice)(chosen % MPTUNE_STATES);
    return (found > 0U) ? 1U : 0U;
}
