"""The part of the monitor in C that is the same for all specs."""

SOURCE = """\

#include "@SPEC@_monitor.h"

#if defined(__FAST_MATH__)
#error "comparisons with what is not a number have to be false: compile without -ffast-math"
#endif
@FINITE@
/* Beyond it, no robot gets. */
#define NOWHERE 1.0e6F

static void note(@OWN@_monitor_t *m, bool left, uint32_t kind)
{
    if (left && (m->left == @UP@_LEFT_NONE)) {
        m->left = kind;
    }
}

static float size_of(float x)
{
    return (x < 0.0F) ? -x : x;
}

static void follow(@OWN@_monitor_t *m, uint32_t mode)
{
@STAYS@    if (m->begun && (mode != m->mode)) {
        note(m, !follows[m->mode][mode], @UP@_LEFT_ORDER);
        /* How long the first mode was in force before the monitor began is not known. */
        note(m, m->switched && (m->stay < shortest[m->mode]), @UP@_LEFT_STAY);
        m->switched = true;
        m->stay = 0U;
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

void @OWN@_monitor_init(@OWN@_monitor_t *m, float jitter)
{
    m->jitter = jitter;
    m->left = @UP@_LEFT_NONE;
    m->sample = 0U;
    m->mode = 0U;
    m->stay = 0U;
    m->begun = false;
    m->switched = false;
}

uint32_t @OWN@_monitor_step(const @OWN@_monitor_input_t *in, @OWN@_monitor_t *m)
{
    if ((in->mode >= @UP@_MODES) || !((in->angle > -NOWHERE) && (in->angle < NOWHERE))) {
        note(m, true, @UP@_LEFT_INPUT);
    } else if (m->left == @UP@_LEFT_NONE) {
        follow(m, in->mode);
        check(in, m);
    } else {
        /* It was left before. */
    }
    if ((m->left == @UP@_LEFT_NONE) && (m->sample < UINT32_MAX)) {
        m->sample++;
    }
    return m->left;
}
"""
