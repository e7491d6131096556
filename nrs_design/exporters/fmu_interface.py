"""What FMI 2.0 fixes, in C: names, types and order of arguments.

For `nrs_design.exporters.fmu_source`, which puts the law in the places between two @.
"""

from __future__ import annotations

INTERFACE = """\
@ABOUT@
#include "@SPEC@.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* What FMI 2.0 fixes. */
typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;
typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum {
    fmi2DoStepStatus,
    fmi2PendingStatus,
    fmi2LastSuccessfulTime,
    fmi2Terminated
} fmi2StatusKind;
typedef struct {
    void (*logger)(
        fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);
    void *(*allocateMemory)(size_t, size_t);
    void (*freeMemory)(void *);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

/* Functions begin with a name of their own where many models go into one program. */
#define FMI2_JOINED(a, b) a##b
#define FMI2_NAMED(a, b) FMI2_JOINED(a, b)
#if defined(FMI2_FUNCTION_PREFIX)
#define FMI2(name) FMI2_NAMED(FMI2_FUNCTION_PREFIX, name)
#else
#define FMI2(name) name
#endif
#if defined(_WIN32)
#define FMI2_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define FMI2_EXPORT __attribute__((visibility("default")))
#else
#define FMI2_EXPORT
#endif

#define PERIOD @PERIOD@
/* A communication step is a whole number of sample times, to this part of one. */
#define PART 1e-6
#define MOST_SAMPLES 1e9

"""
