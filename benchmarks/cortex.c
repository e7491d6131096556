/* Counts the instructions of one step after the other: the emulator's clock advances by the same
   time with each, and the timer of the processor counts that clock. */
#include "law.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define CONTROL (*(volatile uint32_t *)0xe000e010U)
#define RELOAD (*(volatile uint32_t *)0xe000e014U)
#define NOW (*(volatile uint32_t *)0xe000e018U)
#define LARGEST 0xffffffU

input_t in;
#if HAS_STATE
state_t state;
#endif
output_t out;

#if HAS_STATE
typedef void (*step_t)(const input_t *, state_t *, output_t *);
#define CALL(law) (law)(&in, &state, &out)
#define NOTHING const input_t *i, state_t *s, output_t *o
#else
typedef void (*step_t)(const input_t *, output_t *);
#define CALL(law) (law)(&in, &out)
#define NOTHING const input_t *i, output_t *o
#endif

__attribute__((noinline)) static void nothing(NOTHING)
{
    __asm__ volatile("" : : "r"(i), "r"(o) : "memory");
}

__attribute__((noinline)) static uint32_t ticks_of(step_t law)
{
    uint32_t before;
    CONTROL = 0U;
    RELOAD = LARGEST;
    NOW = 0U;
    CONTROL = 5U;
    before = NOW;
    CALL(law);
    return (before - NOW) & LARGEST;
}

int main(void)
{
    for (unsigned k = 0U; k < COUNT; k++) {
        uint32_t taken;
        uint32_t idle;
        (void)memcpy(&in, &cases[k][0], sizeof in);
#if HAS_STATE
        (void)memcpy(&state, &cases[k][sizeof in / 4U], sizeof state);
#endif
        idle = ticks_of(nothing);
        taken = ticks_of(STEP);
        (void)printf("%lu\n", (unsigned long)(taken - idle));
    }
    return 0;
}
