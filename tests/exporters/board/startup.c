/* Start of a test program on an emulated Cortex-M4F; text and exit code leave by semihosting. */
#include <stdint.h>
#include <stdio.h>

extern uint32_t stack_top, data_from, data_begin, data_end, bss_begin, bss_end;
int main(void);
void begin(void);
void run(void);
void stopped(void);
int _write(int file, const char *text, int length);
void _exit(int code);

__attribute__((section(".vectors"), used)) static void *const vectors[16] = {
    &stack_top, (void *)begin, (void *)stopped, (void *)stopped,
    (void *)stopped, (void *)stopped, (void *)stopped
};

static int32_t ask_host(int32_t what, const void *with)
{
    register int32_t r0 __asm__("r0") = what;
    register const void *r1 __asm__("r1") = with;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

int _write(int file, const char *text, int length)
{
    (void)file;
    for (int i = 0; i < length; i++) {
        (void)ask_host(0x03, &text[i]);
    }
    return length;
}

void _exit(int code)
{
    const uint32_t why[2] = {0x20026U, (uint32_t)code};
    for (;;) {
        (void)ask_host(0x20, why);
    }
}

void stopped(void)
{
    _exit(99);
}

/* The unit for floating point is off at first: it is switched on before compiled code may use it. */
__attribute__((naked)) void begin(void)
{
    __asm__ volatile(".syntax unified\n"
                     "ldr r0, =0xe000ed88\n"
                     "ldr r1, =0xf00000\n"
                     "ldr r2, [r0]\n"
                     "orrs r1, r1, r2\n"
                     "str r1, [r0]\n"
                     "dsb\n"
                     "isb\n"
                     "b run\n");
}

__attribute__((used)) void run(void)
{
    uint32_t *from = &data_from;
    for (uint32_t *to = &data_begin; to < &data_end; to++) {
        *to = *from++;
    }
    for (uint32_t *to = &bss_begin; to < &bss_end; to++) {
        *to = 0U;
    }
    const int code = main();
    (void)fflush(stdout);
    _exit(code);
}
