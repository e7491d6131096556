#include "soft-tissue_monitor.h"

volatile uint32_t any;
volatile float any_number;

int main(void)
{
    static nrs_soft_tissue_monitor_t m;
    nrs_soft_tissue_monitor_init(&m, any_number);
    for (;;) {
        nrs_soft_tissue_monitor_input_t in;
        in.mode = any;
        in.age = any;
        in.step = any_number;
        in.angle = any_number;
        in.torque = any_number;
        in.command = any_number;
        (void)nrs_soft_tissue_monitor_step(&in, &m);
        if (any != 0U) {
            nrs_soft_tissue_monitor_init(&m, any_number);
        }
    }
}
