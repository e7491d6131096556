/* Many runs of an exported law in contact, each watched by its exported monitor.
 *
 * Motor and joint are exact between samples; noise goes through the loop. `study RUNS SEED` draws
 * runs that keep what the monitor is told, and prints for each kind of stiffness: runs, alarms,
 * samples in contact, judged samples. `study RUNS SEED C N PER` draws a stiffness C times the
 * range, and prints: runs with more than 20 mN m, those found, samples beyond N + PER times the
 * travel at the touch, those of them before which nothing was told.
 */
#include "x.h"
#include "x_monitor.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#ifndef SECONDS
#define SECONDS 8.0
#endif
#define PERIOD 0.002
#define GAIN 4.8417e-4
#define TAU 0.0351
#define SIGN_OF(x) (((x) < 0.0) ? -1.0 : 1.0)

enum { CONSTANT, JUMPS, WHITE, STIFFENING, SINE, SIGNED, ADVERSARY, BIASED, NORMAL, KINDS };
static const char *const names[] = {
    "constant", "jumps", "white", "stiffening", "sine", "sign of velocity", "adversary",
    "noise at its bound", "clipped normal noise"};

static unsigned long long seed;

static double uniform(double low, double high)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return low + (high - low) * (double)(seed >> 11) * 0x1p-53;
}

typedef struct {
    double k[2], e[2], start, phase, rate, hand, until;
    int kind;
} draw_t;

/* A stiffness and noises that the monitor is told to expect; the adversary shrinks its interval. */
static void choose(draw_t *d, double t, double depth, double v)
{
    const double middle = (LOW + HIGH) / 2.0;
    const double half = (HIGH - LOW) / 2.0;
    const double turn = d->phase + d->rate * t;
    int i;
    d->k[0] = middle + half * sin(turn);
    for (i = 0; i < 2; i++) {
        d->e[i] = uniform(-1.0, 1.0);
    }
    if (d->kind == CONSTANT) {
        d->k[0] = middle + half * sin(d->phase);
    } else if (d->kind == JUMPS) {
        d->k[0] = (sin(turn) > 0.0) ? LOW : HIGH;
    } else if (d->kind == WHITE) {
        d->k[0] = uniform(LOW, HIGH);
    } else if (d->kind == STIFFENING) {
        d->k[0] = middle + half * sin(d->phase) * fmax(-1.0, fmin(1.0, 1e3 * depth - 2.0));
    } else if (d->kind == SIGNED) {
        d->k[0] = (v * sin(d->phase) > 0.0) ? HIGH : LOW;
    } else if (d->kind == ADVERSARY) {
        /* Either end of what the sample leaves is the surface itself. */
        const double way = SIGN_OF(uniform(-1.0, 1.0));
        d->k[0] = (way * depth > 0.0) ? LOW : HIGH;
        d->e[0] = -way;
        d->e[1] = way;
    } else if (d->kind == BIASED) {
        d->e[0] = SIGN_OF(sin(d->phase));
        d->e[1] = SIGN_OF(v);
    } else if (d->kind == NORMAL) {
        for (i = 0; i < 2; i++) {
            const double n = sqrt(-2.0 * log(uniform(1e-300, 1.0))) * cos(6.2831853 * d->e[i]);
            d->e[i] = fmax(-1.0, fmin(1.0, n / 3.0));
        }
    } else {
        /* A sine. */
    }
}

/* The hand presses, pauses and withdraws. */
static double commanded(draw_t *d, double t)
{
    if (t >= d->until) {
        /* Half of them are slow. */
        d->hand = uniform(-0.11, 0.139) * pow(10.0, fmin(uniform(-1.0, 1.0), 0.0));
        d->until = t + uniform(0.05, 1.5);
    }
    return d->hand;
}

typedef struct {
    unsigned long runs, alarms, touched, judged, samples, strong, found, beyond, missed;
} sums_t;

static void run(int kind, double c, double need, double per, sums_t *sums)
{
    static nrs_x_monitor_t m;
    nrs_x_state_t state;
    nrs_x_output_t out;
    const double decay = exp(-PERIOD / TAU);
    const double centre = uniform(-3.1, 3.1);
    const long count = (long)(SECONDS / PERIOD);
    draw_t d = {{0.0, 0.0}, {0.0, 0.0}, 0.0, 0.0, 0.0, 0.0, 0.0, 0};
    double theta = centre;
    double v = 0.0;
    double surface = KEPT ? centre : centre + uniform(0.0, 0.02);
    double place = surface;
    double torque = 0.0;
    double read[2] = {0.0, 0.0};
    double before = theta - surface;
    double travel = 0.0;
    double deepest = 0.0;
    bool fast = false;
    bool certain = false;
    uint32_t left = 0U;
    uint32_t mode = 0U;
    uint32_t age = MOVES ? (uint32_t)(uniform(0.0, 2.0)) : 0U;
    long k;

    d.kind = kind;
    d.phase = uniform(0.0, 6.2831853);
    d.rate = uniform(0.5, 60.0);
    nrs_x_init(&state, (float)theta);
    nrs_x_monitor_init(&m, 1.0e-4F);
    for (k = 0; (k < count) && (left == 0U); k++) {
        const double t = (double)k * PERIOD;
        nrs_x_monitor_input_t seen = {0U, 0.002F, 0U, 0.0F, 0.0F, 0.0F};
        nrs_x_input_t in = {0U, 0.0F, 0.0F, 0.0F};
        double depth;
        double felt;
        double angle;
        if (c > 0.0) {
            /* It stands still. */
        } else if ((MOVES == 1) && (theta < surface) && (uniform(0.0, 1.0) < 0.02)) {
            surface = theta + uniform(0.0, 0.003);
        } else if ((MOVES == 2) && !certain && (uniform(0.0, 1.0) < 0.02)) {
            surface = theta + uniform(-0.004, 0.003);
        } else if (DRIFT > 0.0) {
            surface = place + DRIFT / d.rate * sin(d.rate * t);
        } else {
            /* It stands still. */
        }
        depth = theta - surface;
        choose(&d, t, depth, v);
        if (c > 0.0) {
            const double way = SIGN_OF((depth * d.k[0] - 0.01) * (c - 1.0)) * ((kind % 2) ? 1.0 : 0.0);
            d.k[0] = c * ((c > 1.0) ? HIGH : LOW);
            d.e[0] = (way != 0.0) ? -way : d.e[0];
            d.e[1] = (way != 0.0) ? way : d.e[1];
        }
        read[1] = read[0];
        felt = depth + SKEW * SPEED * uniform(-1.0, 1.0);
        torque = (KEPT || (felt > 0.0)) ? (d.k[0] * felt + DAMPING * v) : 0.0;
        torque = KEPT ? torque : fmax(torque, 0.0);
        read[0] = torque + TORQUE_NOISE * d.e[0];
        if (torque <= 0.0) {
            travel = 0.0;
        } else if (!certain) {
            travel = fmax(travel, fabs(depth - before));
        } else {
            /* In contact. */
        }
        certain = (read[0] - TORQUE_NOISE - DAMPING * SPEED) > 0.0;
        angle = theta + ANGLE_NOISE * d.e[1];
        if (c > 0.0) {
            age = 0U;
        } else if (!MOVES) {
            age = (uint32_t)uniform(0.0, 2.0);
        } else {
            /* The same all the time, so that no torque stays unread. */
        }
        if (uniform(0.0, 1.0) < 0.01) {
            mode = 1U - mode;
        }
        in.mode = mode;
        in.angle = (float)angle;
        in.torque = (float)read[((k > 0) && (age > 0U)) ? 1 : 0];
        in.velocity_command = (float)commanded(&d, t);
        nrs_x_step(&in, &state, &out);
        seen.mode = mode;
        seen.age = (k > 0) ? age : 0U;
        seen.angle = in.angle;
        seen.torque = in.torque;
        seen.command = out.command;
        left = nrs_x_monitor_step(&seen, &m);
        deepest = fmax(deepest, torque);
        if ((c > 0.0) && (k > 1) && (seen.age == 0U) && (torque > (need + per * travel))) {
            sums->beyond++;
            sums->missed += (left == 0U) ? 1UL : 0UL;
        }
        fast = fast || (fabs(v) > SPEED) || !out.valid;
        before = depth;
        {
            const double target = GAIN * (double)out.command;
            theta += target * PERIOD + (v - target) * TAU * (1.0 - decay);
            v = target + (v - target) * decay;
        }
    }
    if ((SPEED < 1.0) && fast) {
        return;
    }
    sums->runs++;
    sums->alarms += (left != 0U) ? 1UL : 0UL;
    sums->touched += m.touched;
    sums->judged += m.judged;
    sums->samples += m.sample;
    sums->strong += (deepest > 0.02) ? 1UL : 0UL;
    sums->found += ((deepest > 0.02) && (left == NRS_X_LEFT_STIFFNESS)) ? 1UL : 0UL;
}

int main(int argc, char **argv)
{
    const long runs = atol(argv[1]);
    const double c = (argc > 3) ? atof(argv[3]) : 0.0;
    int kind;
    seed = strtoull(argv[2], NULL, 10) * 0x9E3779B97F4A7C15ULL + 1ULL;
    for (kind = 0; kind < KINDS; kind++) {
        sums_t s = {0UL, 0UL, 0UL, 0UL, 0UL, 0UL, 0UL, 0UL, 0UL};
        long k;
        for (k = kind; k < runs; k += KINDS) {
            run(kind, c, (argc > 4) ? atof(argv[4]) : 0.0, (argc > 5) ? atof(argv[5]) : 0.0, &s);
        }
        if (c > 0.0) {
            (void)printf("%s,%lu,%lu,%lu,%lu\n", names[kind], s.strong, s.found, s.beyond, s.missed);
        } else {
            (void)printf("%s,%lu,%lu,%lu,%lu,%lu\n", names[kind], s.runs, s.alarms, s.touched, s.judged, s.samples);
        }
    }
    return 0;
}
