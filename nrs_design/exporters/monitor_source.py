"""The part of the monitor in C that is the same for all specs."""

SOURCE = """\

#include "@SPEC@_monitor.h"

#if defined(__FAST_MATH__)
#error "comparisons with what is not a number have to be false: compile without -ffast-math"
#endif
@FINITE@
/* Beyond it, no robot gets. */
#define NOWHERE 1.0e6F
/* Less than this part of the least stiffness is no contact. */
#define FREE 0.1F

@COUNTS@
/* What a window shows: stiffness k, the squared half width of its interval, the same of the reverse
   regression, and which part of the power of the angle is no noise. */
typedef struct {
    bool told;
    float k;
    float half;
    float yielding;
    float reverse;
    float real;
} window_t;

static void note(@OWN@_monitor_t *m, bool left, uint32_t kind)
{
    if (left && (m->left == @UP@_LEFT_NONE)) {
        m->left = kind;
    }
}

static float squared(float x)
{
    return x * x;
}

static float size_of(float x)
{
    return (x < 0.0F) ? -x : x;
}

static float mean(const float *x)
{
    float sum = 0.0F;
    uint32_t i;
    for (i = 0U; i < @UP@_MONITOR_WINDOW; i++) {
        sum += x[i] - x[0];
    }
    return x[0] + (sum / (float)@UP@_MONITOR_WINDOW);
}

/* The angle's change over a sample; its scale does not matter. */
static float change(const float *x, uint32_t i)
{
    const uint32_t last = @UP@_MONITOR_WINDOW - 1U;
    float difference;
    if (i == 0U) {
        difference = x[1] - x[0];
    } else if (i >= last) {
        difference = x[last] - x[last - 1U];
    } else {
        difference = 0.5F * (x[i + 1U] - x[i - 1U]);
    }
    return difference;
}

/* Variance of white noise on the angle, by its third differences, and of its rounding. */
static float noise(const float *x)
{
    const uint32_t count = @UP@_MONITOR_WINDOW - 3U;
    float sum = 0.0F;
    float least = 0.0F;
    uint32_t i;
    for (i = 3U; i < @UP@_MONITOR_WINDOW; i++) {
        sum += squared((x[i] - x[i - 3U]) - (3.0F * (x[i - 1U] - x[i - 2U])));
    }
    for (i = 1U; i < @UP@_MONITOR_WINDOW; i++) {
        const float step = size_of(x[i] - x[i - 1U]);
        if ((step > 0.0F) && ((least <= 0.0F) || (step < least))) {
            least = step;
        }
    }
    return (sum / (20.0F * (float)count)) + (squared(least) / 12.0F);
}

/* The squared half width of an interval: rests of the regression may be alike. */
static float squared_half(float rest, float lagged, float power)
{
    const uint32_t freedom = @UP@_MONITOR_WINDOW - 3U;
    float more = 1.0F;
    float less = 1.0F;
    if (rest > 0.0F) {
        const float alike = lagged / rest;
        less -= alike;
        if (alike > 0.0F) {
            more += alike;
        }
        if (less < 1.0e-3F) {
            less = 1.0e-3F;
        }
    }
    return squared(@UP@_MONITOR_QUANTILE) * ((rest / (float)freedom) / power) * (more / less);
}

/* What angle and torque are without their means, and without what the velocity explains. */
typedef struct {
    float x0;
    float f0;
    float v0;
    float xv;
    float fv;
} base_t;

static base_t base_of(const @OWN@_monitor_t *m)
{
    const uint32_t last = @UP@_MONITOR_WINDOW - 1U;
    base_t b = {0.0F, 0.0F, 0.0F, 0.0F, 0.0F};
    float vv = 0.0F;
    uint32_t i;
    b.x0 = mean(m->angle);
    b.f0 = mean(m->torque);
    b.v0 = (m->angle[last] - m->angle[0]) / (float)last;
    for (i = 0U; i < @UP@_MONITOR_WINDOW; i++) {
        const float v = change(m->angle, i) - b.v0;
        vv += squared(v);
        b.xv += (m->angle[i] - b.x0) * v;
        b.fv += (m->torque[i] - b.f0) * v;
    }
    if (vv > 0.0F) {
        b.xv /= vv;
        b.fv /= vv;
    }
    return b;
}

static float angle_at(const @OWN@_monitor_t *m, const base_t *b, uint32_t i)
{
    return (m->angle[i] - b->x0) - (b->xv * (change(m->angle, i) - b->v0));
}

static float torque_at(const @OWN@_monitor_t *m, const base_t *b, uint32_t i)
{
    return (m->torque[i] - b->f0) - (b->fv * (change(m->angle, i) - b->v0));
}

/* Regress the torque on angle and velocity, and the angle on the torque. */
static window_t look(const @OWN@_monitor_t *m)
{
    window_t w = {false, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F};
    const base_t b = base_of(m);
    float xx = 0.0F;
    float xf = 0.0F;
    float ff = 0.0F;
    uint32_t i;
    for (i = 0U; i < @UP@_MONITOR_WINDOW; i++) {
        const float x = angle_at(m, &b, i);
        const float f = torque_at(m, &b, i);
        xx += squared(x);
        xf += x * f;
        ff += squared(f);
    }
    if ((xx > 1.0e-20F) && (ff > 0.0F)) {
        float rest = 0.0F;
        float lagged = 0.0F;
        float back = 0.0F;
        float lagged_back = 0.0F;
        float r0 = 0.0F;
        float s0 = 0.0F;
        w.told = true;
        w.k = xf / xx;
        w.yielding = size_of(xf) / ff;
        for (i = 0U; i < @UP@_MONITOR_WINDOW; i++) {
            const float x = angle_at(m, &b, i);
            const float f = torque_at(m, &b, i);
            const float r = f - (w.k * x);
            const float s = x - ((xf / ff) * f);
            rest += squared(r);
            back += squared(s);
            lagged += r * r0;
            lagged_back += s * s0;
            r0 = r;
            s0 = s;
        }
        w.half = squared_half(rest, lagged, xx);
        w.reverse = squared_half(back, lagged_back, ff);
        w.real = 1.0F - ((2.0F * noise(m->angle) * (float)@UP@_MONITOR_WINDOW) / xx);
    }
    return w;
}

/* Whether the whole interval of the size of the stiffness is below, or above. */
static bool is_below(const window_t *w, float limit)
{
    const float gap = w->yielding - (1.0F / limit);
    const float room = (limit * w->real) - size_of(w->k);
    return ((gap > 0.0F) && (w->reverse < squared(gap))) ||
        ((room > 0.0F) && (w->half < squared(room)));
}

static bool is_above(const window_t *w, float limit)
{
    const float gap = size_of(w->k) - limit;
    return (gap > 0.0F) && (w->half < squared(gap));
}

@KEPT@static void judge(@OWN@_monitor_t *m)
{
@RANGE@    const window_t w = look(m);
    const uint32_t count = ranges[m->mode];
    float least = range[m->mode][0][0];
    bool outside = w.told@AND_KEPT@;
    uint32_t i;
    for (i = 0U; i < count; i++) {
        const float low = range[m->mode][i][0];
        const float high = range[m->mode][i][1];
        if (low < least) {
            least = low;
        }
        /* What is negative for certain is in no range. */
        if (w.k < 0.0F) {
            outside = outside && is_above(&w, 0.0F);
        } else {
            outside = outside && (is_below(&w, low) || is_above(&w, high));
        }
    }
    /* Of free motion the size is small, whatever its sign. */
    if (w.told && is_below(&w, FREE * least)) {
        note(m, true, @CONTACT@);
    } else {
        note(m, outside, @UP@_LEFT_STIFFNESS);
    }
}

static void follow(@OWN@_monitor_t *m, uint32_t mode)
{
@STAYS@    if (m->begun && (mode != m->mode)) {
        note(m, !follows[m->mode][mode], @UP@_LEFT_ORDER);
        /* How long the first mode was in force before the monitor began is not known. */
        note(m, m->switched && (m->stay < shortest[m->mode]), @UP@_LEFT_STAY);
        m->switched = true;
        m->stay = 0U;
        m->count = 0U;
    }
    m->begun = true;
    m->mode = mode;
    if (m->stay < UINT32_MAX) {
        m->stay++;
    }
    note(m, m->stay > longest[mode], @UP@_LEFT_STAY);
}

static void check(const @OWN@_monitor_input_t *in, @OWN@_monitor_t *m)
{
    note(m, !(size_of(in->step - @UP@_MONITOR_PERIOD) <= m->jitter), @UP@_LEFT_JITTER);
@CHECKS@    note(m, !(size_of(in->torque) <= @UP@_MONITOR_TORQUE), @UP@_LEFT_FORCE);
}

static void keep(const @OWN@_monitor_input_t *in, @OWN@_monitor_t *m)
{
    if ((m->left == @UP@_LEFT_NONE) && (ranges[m->mode] > 0U)) {
        if (m->count < @UP@_MONITOR_WINDOW) {
            m->angle[m->count] = in->angle;
            m->torque[m->count] = in->torque;
            m->count++;
        }
        if (m->count >= @UP@_MONITOR_WINDOW) {
            judge(m);
            m->count = 0U;
        }
    }
}

void @OWN@_monitor_init(@OWN@_monitor_t *m, float jitter)
{
    m->jitter = jitter;
    m->left = @UP@_LEFT_NONE;
    m->sample = 0U;
    m->mode = 0U;
    m->stay = 0U;
    m->begun = false;
    m->switched = false;
    m->count = 0U;
}

uint32_t @OWN@_monitor_step(const @OWN@_monitor_input_t *in, @OWN@_monitor_t *m)
{
    if ((in->mode >= @UP@_MODES) || !((in->angle > -NOWHERE) && (in->angle < NOWHERE))) {
        note(m, true, @UP@_LEFT_INPUT);
    } else if (m->left == @UP@_LEFT_NONE) {
        follow(m, in->mode);
        check(in, m);
        keep(in, m);
    } else {
        /* It was left before. */
    }
    if ((m->left == @UP@_LEFT_NONE) && (m->sample < UINT32_MAX)) {
        m->sample++;
    }
    return m->left;
}
"""

# Where contact may be lost: partly free, a window has a stiffness that no tissue has.
KEPT = """\
/* Whether the torque pushed one way throughout the window, with a quarter of its largest size at
   least: contact was kept, then, also if its zero is off a little. */
static bool kept(const @OWN@_monitor_t *m)
{
    float least = size_of(m->torque[0]);
    float most = least;
    bool one_way = true;
    uint32_t i;
    for (i = 1U; i < @UP@_MONITOR_WINDOW; i++) {
        const float size = size_of(m->torque[i]);
        one_way = one_way && ((m->torque[i] > 0.0F) == (m->torque[0] > 0.0F));
        if (size < least) {
            least = size;
        }
        if (size > most) {
            most = size;
        }
    }
    return one_way && (least > 0.0F) && (least >= (0.25F * most));
}

"""
