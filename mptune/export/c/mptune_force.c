/* The force controller: estimator (Eq. 4 and 5), cost (Eq. 7 and 8), decision over all pairs of states.
 * What goes beyond the paper's own decision stands in mptune_horizon.c. */
#include "mptune_parts.h"

/* The signed root of a pressure difference, Pa^0.5, smooth about zero. */
static mptune_real orifice(mptune_real difference)
{
    const mptune_real transition = mptune_study.transition_pressure;
    const mptune_real size = MPTUNE_ABS(difference);
    mptune_real root = R(0);
    if (size >= transition) {
        root = MPTUNE_SQRT(size); /* Eq. 2 */
        if (difference < R(0)) {
            root = -root;
        }
    } else {
        root = difference * (R(3) - size / transition) / (R(2) * MPTUNE_SQRT(transition));
    }
    return root;
}

mptune_real mptune_stiffness(uint32_t chamber, mptune_real position)
{
    const mptune_parameters *const p = &mptune_study;
    const mptune_size *const size = &mptune_chambers[chamber];
    const mptune_real away = (size->pulls != 0U) ? (p->stroke - position) : position;
    const mptune_real volume = size->area * away + size->dead;
    const mptune_real modulus =
        R(1) / (R(1) / p->oil + size->hose / volume * (R(1) / p->hose)); /* Eq. 4 */
    return modulus / volume;
}

mptune_chamber mptune_chamber_of(
    uint32_t chamber, mptune_real pressure, mptune_real position, mptune_real velocity,
    mptune_real period)
{
    const mptune_size *const size = &mptune_chambers[chamber];
    mptune_chamber one;
    one.pressure = pressure;
    one.taken = (size->pulls != 0U) ? (-size->area * velocity) : (size->area * velocity);
    one.period = period;
    one.scale = size->flow_coefficient;
    for (uint32_t k = 0U; k <= MPTUNE_STEPS; k++) {
        one.path[k] =
            mptune_stiffness(chamber, position + velocity * period * R(k) / R(MPTUNE_STEPS));
    }
    return one;
}

/* Flow over flow coefficient into a chamber at a pressure, Pa^0.5. */
static mptune_real inflow(
    const mptune_port *port, const mptune_real supplies[MPTUNE_LINES], mptune_real pressure)
{
    mptune_real flow = port->first_count * orifice(supplies[port->first] - pressure);
    if (port->second_count > R(0)) {
        flow += port->second_count * orifice(supplies[port->second] - pressure);
    }
    return flow;
}

mptune_real mptune_predict(
    const mptune_chamber *one, const mptune_port *port, const mptune_real supplies[MPTUNE_LINES])
{
    const mptune_real scale = one->scale;
    const mptune_real step = one->period / R(MPTUNE_STEPS);
    mptune_real pressure = one->pressure;
    for (uint32_t k = 0U; k < MPTUNE_STEPS; k++) {
        const mptune_real slope_1 =
            one->path[k] * (scale * inflow(port, supplies, pressure) - one->taken);
        const mptune_real ahead = pressure + step * slope_1;
        const mptune_real slope_2 =
            one->path[k + 1U] * (scale * inflow(port, supplies, ahead) - one->taken);
        pressure += R(0.5) * step * (slope_1 + slope_2); /* Eq. 5 */
    }
    return pressure;
}

mptune_real mptune_converter_place(uint32_t line, const mptune_real converters[MPTUNE_PLACES])
{
    const uint32_t converter = mptune_lines[line].converter;
    return (converter < MPTUNE_PLACES) ? converters[converter] : R(0);
}

mptune_real mptune_beyond_limits(mptune_real after)
{
    const mptune_parameters *const p = &mptune_study;
    mptune_real penalty = MPTUNE_OUT_OF_RANGE;
    if (p->weight_pressure > R(0)) {
        penalty = p->weight_pressure * mptune_max(p->pressure_min - after, after - p->pressure_max);
    }
    return penalty;
}

/* What one line's valves cost: loss in J, Eq. 8, and Q_conv x^3 in m^6/s. */
static void add_port(
    uint32_t supply, mptune_real count, mptune_real before, mptune_real after,
    const mptune_real supplies[MPTUNE_LINES], const mptune_real converters[MPTUNE_PLACES],
    mptune_real *loss, mptune_real *conversion)
{
    const mptune_parameters *const p = &mptune_study;
    const mptune_real scale = p->flow_coefficient * count;
    const mptune_real drop_now = supplies[supply] - before;
    const mptune_real drop_then = supplies[supply] - after;
    const mptune_real flow_now = scale * orifice(drop_now);
    const mptune_real flow_then = scale * orifice(drop_then);
    *loss += R(0.5) * p->sampling_period
             * (flow_now * drop_now + flow_then * drop_then); /* Eq. 8 */
    const mptune_real share = p->predicted_share;
    const mptune_real drawn = share * flow_then + (R(1) - share) * flow_now;
    const mptune_real place = mptune_converter_place(supply, converters);
    *conversion += -drawn * (place * (place * place));
}

/* The force of every state of one side, N, and what it costs beside the force error, N. */
static void side_costs(
    const mptune_chamber *one, mptune_real area, uint32_t present, const mptune_real supplies[MPTUNE_LINES],
    const mptune_real converters[MPTUNE_PLACES], mptune_real force[MPTUNE_STATES],
    mptune_real cost[MPTUNE_STATES])
{
    const mptune_parameters *const p = &mptune_study;
    for (uint32_t i = 0U; i < MPTUNE_STATES; i++) {
        const mptune_port *const port = &mptune_ports[i];
        const mptune_real after = mptune_predict(one, port, supplies);
        mptune_real loss = R(0);
        mptune_real conversion = R(0);
        if (port->first_count > R(0)) {
            add_port(port->first, port->first_count, one->pressure, after, supplies, converters,
                     &loss, &conversion);
        }
        if (port->second_count > R(0)) {
            add_port(port->second, port->second_count, one->pressure, after, supplies,
                     converters, &loss, &conversion);
        }
        mptune_real total = p->weight_switching * R(mptune_switches[present][i]); /* Eq. 7 */
        total += p->weight_loss * loss;
        total += p->weight_converter * conversion;
        if ((after < p->pressure_min) || (after > p->pressure_max)) {
            total += mptune_beyond_limits(after);
        }
        force[i] = area * after;
        cost[i] = total;
    }
}

/* Take the cheapest of all combinations, the first of several equal ones. */
static uint8_t cheapest(
    mptune_real wanted, const mptune_real force_a[MPTUNE_STATES],
    const mptune_real cost_a[MPTUNE_STATES], const mptune_real force_b[MPTUNE_STATES],
    const mptune_real cost_b[MPTUNE_STATES], mptune_choice choice[2])
{
    mptune_real best = MPTUNE_BEYOND;
    uint8_t found = 0U;
    choice[0] = 0U;
    choice[1] = 0U;
    for (uint32_t a = 0U; a < MPTUNE_STATES; a++) {
        for (uint32_t b = 0U; b < MPTUNE_STATES; b++) {
            const mptune_real total =
                MPTUNE_ABS(wanted - (force_a[a] - force_b[b])) + cost_a[a] + cost_b[b]; /* Eq. 7 */
            if (total < best) {
                best = total;
                choice[0] = (mptune_choice)a;
                choice[1] = (mptune_choice)b;
                found = 1U;
            }
        }
    }
    return found;
}

/* Whether anything is decided otherwise than by Eq. 7 and 8 as printed. */
static uint8_t beyond_the_paper(void)
{
    const mptune_parameters *const p = &mptune_study;
    const uint8_t other = (p->error_width > R(0)) || (p->path_loss > R(0))
                          || (p->candidates > R(0)) || (p->weight_common_mode > R(0))
                          || (p->steady_state > R(0));
    return other;
}

uint8_t mptune_decide(mptune_state *state, mptune_real velocity)
{
    const mptune_parameters *const p = &mptune_study;
    const mptune_real lag = p->delay_prediction;
    mptune_real pressure_a = state->filtered[MPTUNE_CHAMBER_A];
    mptune_real pressure_b = state->filtered[MPTUNE_CHAMBER_B];
    mptune_real position = mptune_position(state);
    mptune_real supplies[MPTUNE_LINES];
    for (uint32_t i = 0U; i < MPTUNE_LINES; i++) {
        const mptune_line *const line = &mptune_lines[i];
        const mptune_real base = (line->rests != 0U) ? state->filtered[MPTUNE_LOW] : line->base;
        supplies[i] = base + line->share * (state->filtered[MPTUNE_HIGH] - base);
    }
    if (MPTUNE_CHAMBERS > MPTUNE_USUAL) {
        return mptune_decide_of_chambers(state, velocity, supplies);
    }
    if (lag > R(0)) { /* carried through the valve delay with the present states */
        const mptune_chamber a = mptune_chamber_of(MPTUNE_FIRST, pressure_a, position, velocity, lag);
        const mptune_chamber b = mptune_chamber_of(MPTUNE_SECOND, pressure_b, position, velocity, lag);
        pressure_a = mptune_predict(&a, &mptune_ports[state->choice[0]], supplies);
        pressure_b = mptune_predict(&b, &mptune_ports[state->choice[1]], supplies);
        position += velocity * lag;
    }
    if (beyond_the_paper() != 0U) {
        const mptune_situation now = {pressure_a, pressure_b, position, velocity, state->force};
        return mptune_best_ahead(&now, supplies, state->converters, state->choice);
    }
    mptune_real force_a[MPTUNE_STATES];
    mptune_real cost_a[MPTUNE_STATES];
    mptune_real force_b[MPTUNE_STATES];
    mptune_real cost_b[MPTUNE_STATES];
    const mptune_chamber a =
        mptune_chamber_of(MPTUNE_FIRST, pressure_a, position, velocity, p->sampling_period);
    const mptune_chamber b =
        mptune_chamber_of(MPTUNE_SECOND, pressure_b, position, velocity, p->sampling_period);
    side_costs(&a, p->area_a, state->choice[0], supplies, state->converters, force_a, cost_a);
    side_costs(&b, p->area_b, state->choice[1], supplies, state->converters, force_b, cost_b);
    return cheapest(state->force, force_a, cost_a, force_b, cost_b, state->choice);
}
