#include "x_monitor.h"
#include <stdio.h>
#define TIMER ((volatile uint32_t *)0xe000e010U)
static uint32_t now(void) { return TIMER[2]; }
__attribute__((noinline)) static uint32_t none(
    const nrs_x_monitor_input_t *in, nrs_x_monitor_t *m)
{
    __asm__ volatile("" : : "r"(in), "r"(m) : "memory");
    return 0U;
}
static uint32_t taken(uint32_t (*step)(const nrs_x_monitor_input_t *, nrs_x_monitor_t *),
    const nrs_x_monitor_input_t *in, nrs_x_monitor_t *m)
{
    uint32_t before;
    TIMER[0] = 0U;
    TIMER[1] = 0xffffffU;
    TIMER[2] = 0U;
    TIMER[0] = 5U;
    before = now();
    (void)step(in, m);
    return (before - now()) & 0xffffffU;
}
int main(void)
{
    static nrs_x_monitor_t m;
    uint32_t most = 0U;
    uint32_t k;
    nrs_x_monitor_init(&m, 1.0e-4F);
    for (k = 0U; k < 2000U; k++) {
        const float phase = (float)(k % 400U) * 0.01F;
        const float depth = (phase < 2.0F) ? (phase - 0.5F) : (3.5F - phase);
        nrs_x_monitor_input_t in = {0U, 0.002F, 0U, 0.0F, 0.0F, 0.0F};
        uint32_t ticks;
        in.mode = (k / 40U) % 2U;
        in.age = k % 2U;
        in.angle = 0.001F * depth;
        in.torque = (depth > 0.0F) ? (43.0F * in.angle) : 0.0F;
        if (in.age == 1U) {
            in.torque = m.angles[0] * 43.0F;
            in.torque = (in.torque > 0.0F) ? in.torque : 0.0F;
        }
        in.torque = (k == 0U) ? 0.0F : in.torque;
        ticks = taken(nrs_x_monitor_step, &in, &m) - taken(none, &in, &m);
        most = (ticks > most) ? ticks : most;
    }
    (void)printf("%lu %lu %lu\n", (unsigned long)most, (unsigned long)m.left,
        (unsigned long)m.judged);
    return 0;
}
