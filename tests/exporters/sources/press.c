#include "x_monitor.h"
#include <stdio.h>
int main(void)
{
    static nrs_x_monitor_t m;
    uint32_t left = 0U;
    uint32_t k;
    nrs_x_monitor_init(&m, 1.0e-4F);
    for (k = 0U; (k < 3000U) && (left == 0U); k++) {
        const float phase = (float)(k % 400U) * 0.01F;
        const float back = phase - 2.0F;
        const float way = (back < 0.0F) ? (-phase * back) : (back * (back - 2.0F));
        nrs_x_monitor_input_t in = {0U, 0.002F, 0U, 0.0F, 0.0F, 0.0F};
        in.angle = 0.004F + (0.0015F * way);
        in.torque = ((k < 1000U) ? 43.0F : 45.0F) * in.angle;
        in.torque += (k < 1000U) ? 0.0F : 0.1F;
        left = nrs_x_monitor_step(&in, &m);
    }
    (void)printf("%lu at %lu\n", (unsigned long)left, (unsigned long)m.sample);
    return 0;
}
