/* The envelopes of |D_vel| and |D_pos| (Eq. 16 and 20) over a family, as a plain C loop. */
#include <math.h>

typedef struct { double re, im; } number;

static number times(number a, number b) {
    number c = {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
    return c;
}

static number over(number a, number b) {
    double size = b.re * b.re + b.im * b.im;
    number c = {(a.re * b.re + a.im * b.im) / size, (a.im * b.re - a.re * b.im) / size};
    return c;
}

void family_errors(
    int points, const double *omega, int delays, const double *delay, int lags, const double *tau_a,
    const double *tau_b, const double *share_a, int plants, const double *mass_ratio,
    const long *which_delay, const long *which_lags, double nominal_delay, const number *loop,
    const double *weight, number *lag, number *force, double *left, double *ratio)
{
    for (int i = 0; i < 2 * points; ++i) left[i] = 0.0;
    for (int i = 0; i < 2 * plants; ++i) ratio[i] = 0.0;
    for (int f = 0; f < points; ++f) {
        double w = omega[f];
        for (int i = 0; i < delays; ++i) {
            lag[i].re = cos(w * (delay[i] - nominal_delay));
            lag[i].im = -sin(w * (delay[i] - nominal_delay));
        }
        for (int i = 0; i < lags; ++i) {
            number lead = {1.0, w * (tau_b[i] * share_a[i] + tau_a[i] * (1 - share_a[i]))};
            number slow = {1.0, w * tau_a[i]}, other = {1.0, w * tau_b[i]};
            force[i] = over(lead, times(slow, other));
        }
        for (int n = 0; n < plants; ++n) {
            number velocity = times(force[which_lags[n]], lag[which_delay[n]]);
            velocity.re = velocity.re * mass_ratio[n] - 1;
            velocity.im *= mass_ratio[n];
            number one = {1 + velocity.re, velocity.im};
            number below = times(one, loop[f]);
            below.re += 1;
            number position = over(velocity, below);
            for (int k = 0; k < 2; ++k) {
                number error = k ? position : velocity;
                double size = error.re * error.re + error.im * error.im;
                if (size > left[k * points + f]) left[k * points + f] = size;
                size *= weight[k * points + f] * weight[k * points + f];
                if (size > ratio[k * plants + n]) ratio[k * plants + n] = size;
            }
        }
    }
}
