/*
 * Feed recorded samples to the controller and write down what it does.
 *
 * replay INPUTS OUTPUTS PASSES
 *
 * INPUTS holds doubles: load force, the values of mptune_inputs for mptune_init, then for each step.
 * OUTPUTS takes doubles for each step: force reference, fault, stopped, states of A and B, decided,
 * all valves, states of further chambers. The passes after the first repeat the run from the start; printed is the longest step
 * in ns, for each step the shortest of all passes, so that other programs' interrupts do not count.
 */
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "mptune_controller.h"

#define COLUMNS (8 + MPTUNE_CONVERTERS + MPTUNE_FURTHER)
#define ALL_VALVES (MPTUNE_CHAMBERS * MPTUNE_VALVES)
#define RESULTS (6 + ALL_VALVES + MPTUNE_FURTHER)

static mptune_inputs inputs_of(const double *row)
{
    mptune_inputs in;
    in.position_reference = (mptune_real)row[0];
    in.velocity_reference = (mptune_real)row[1];
    in.acceleration_reference = (mptune_real)row[2];
    in.position = (mptune_real)row[3];
    in.pressure_a = (mptune_real)row[4];
    in.pressure_b = (mptune_real)row[5];
    in.pressure_high = (mptune_real)row[6];
    in.pressure_low = (mptune_real)row[7];
    for (size_t i = 0; i != MPTUNE_CONVERTERS; i++) {
        in.converter[i] = (mptune_real)row[8 + i];
    }
    for (size_t i = 0; i != MPTUNE_FURTHER; i++) {
        in.further[i] = (mptune_real)row[8 + MPTUNE_CONVERTERS + i];
    }
    return in;
}

static void write_row(const mptune_outputs *out, FILE *file)
{
    double row[RESULTS] = {(double)out->force_reference, out->fault, out->stopped,
                           out->state_a, out->state_b, out->decided};
    for (size_t i = 0; i < ALL_VALVES; i++) {
        row[6 + i] = out->valve[i];
    }
    for (size_t i = 0; i != MPTUNE_FURTHER; i++) {
        row[6 + ALL_VALVES + i] = out->state_further[i];
    }
    if (fwrite(row, sizeof(double), RESULTS, file) != RESULTS) {
        exit(3);
    }
}

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e9 * (double)time.tv_sec + (double)time.tv_nsec;
}

int main(int count, char **words)
{
    if (count != 4) {
        return 2;
    }
    FILE *input = fopen(words[1], "rb");
    FILE *output = fopen(words[2], "wb");
    if (input == NULL || output == NULL) {
        return 3;
    }
    fseek(input, 0, SEEK_END);
    const size_t values = (size_t)ftell(input) / sizeof(double);
    rewind(input);
    double *data = malloc(values * sizeof(double));
    const size_t steps = (values - 1 - COLUMNS) / COLUMNS;
    double *shortest = calloc(steps + 1, sizeof(double));
    if (data == NULL || shortest == NULL || fread(data, sizeof(double), values, input) != values) {
        return 3;
    }
    for (int pass = 0; pass < atoi(words[3]); pass++) {
        mptune_state state;
        mptune_outputs out;
        const mptune_inputs first = inputs_of(data + 1);
        mptune_init(&state, &first, (mptune_real)data[0]);
        for (size_t step = 0; step < steps; step++) {
            const mptune_inputs in = inputs_of(data + 1 + COLUMNS * (step + 1));
            const double begin = now();
            mptune_step(&state, &in, &out);
            const double span = now() - begin;
            if (pass == 0 || span < shortest[step]) {
                shortest[step] = span;
            }
            if (pass == 0) {
                write_row(&out, output);
            }
        }
    }
    double longest = 0.0;
    for (size_t step = 0; step < steps; step++) {
        longest = (shortest[step] > longest) ? shortest[step] : longest;
    }
    printf("%.0f\n", longest);
    free(data);
    free(shortest);
    fclose(input);
    return fclose(output) == 0 ? 0 : 3;
}
