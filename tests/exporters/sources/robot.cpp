#include "soft-tissue.h"
#include "soft-tissue_monitor.h"
#include "soft-tissue_test.h"

int main()
{
    nrs_soft_tissue_state_t state;
    nrs_soft_tissue_monitor_t monitor;
    nrs_soft_tissue_init(&state, 0.5F);
    nrs_soft_tissue_monitor_init(&monitor, 0.0F);
    return (state.reference == 0.5F) ? 0 : 1;
}
