"""The C around a law that makes it a co-simulation model by FMI 2.0.

The declarations are the facts that the standard fixes: names, types and order of arguments. Numbers
pass as doubles and are rounded to single precision where the law takes them.
"""

from __future__ import annotations

from nrs_design.controllers.operations import StepLaw
from nrs_design.exporters.c_names import comment
from nrs_design.exporters.fmu_variables import Variables
from nrs_design.exporters.program import Program
from nrs_design.output import C_SOURCE


def wrapper_text(program: Program, guid: str, period: str) -> str:
    """Return the source of the wrapper.

    Parameters
    ----------
    program : Program
        The law that is wrapped.
    guid : str
        By which the description and the program know each other.
    period : str
        Sample time in s, as a decimal.
    """
    law, names = program.law, program.names
    variables = Variables.of(law)
    parts = {
        "ABOUT": comment((*program.about, "It makes a model by FMI 2.0 of the law."), C_SOURCE),
        "SPEC": names.spec,
        "OWN": names.lower,
        "GUID": guid,
        "PERIOD": period,
        "REALS": _cases(variables),
        "INPUTS": str(len(law.inputs)),
        "CLEAR": _clear(law),
    }
    text = _TEXT
    for key, value in parts.items():
        text = text.replace(f"@{key}@", value)
    return text


def _cases(variables: Variables) -> str:
    lines = [f"    case {v.reference}U:\n        return &m->{v.place};\n" for v in variables.reals]
    return "".join(lines)


def _clear(law: StepLaw) -> str:
    zero = [f"    m->in.{v.name} = 0.0F;\n" for v in law.inputs]
    zero += [f"    m->out.{name} = 0.0F;\n" for name in law.outputs]
    return "".join(zero)


_TEXT = """\
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

typedef struct {
    @OWN@_input_t in;
    @OWN@_state_t state;
    @OWN@_output_t out;
    bool runs;
    double end;
    const fmi2CallbackFunctions *host;
    const char *name;
} model_t;

static fmi2Status refuse(const model_t *m, const char *why)
{
    if ((m->host != NULL) && (m->host->logger != NULL)) {
        m->host->logger(
            m->host->componentEnvironment, m->name, fmi2Error, "logStatusError", "%s", why);
    }
    return fmi2Error;
}

static float *real_at(model_t *m, fmi2ValueReference at)
{
    switch (at) {
@REALS@    default:
        return NULL;
    }
}

/* At rest where the joint is. */
static void start(model_t *m)
{
    @OWN@_init(&m->state, m->in.angle);
}

static void clear(model_t *m)
{
    m->in.mode = 0U;
@CLEAR@    m->out.valid = false;
    m->runs = false;
    m->end = 0.0;
    start(m);
}

FMI2_EXPORT const char *FMI2(fmi2GetTypesPlatform)(void)
{
    return "default";
}

FMI2_EXPORT const char *FMI2(fmi2GetVersion)(void)
{
    return "2.0";
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetDebugLogging)(
    fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    (void)c;
    (void)on;
    (void)n;
    (void)categories;
    return fmi2OK;
}

FMI2_EXPORT fmi2Component FMI2(fmi2Instantiate)(
    fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
    const fmi2CallbackFunctions *host, fmi2Boolean visible, fmi2Boolean logging)
{
    model_t *m = NULL;
    model_t asked;
    (void)resources;
    (void)visible;
    (void)logging;
    asked.host = host;
    asked.name = name;
    if ((host == NULL) || (host->allocateMemory == NULL) || (host->freeMemory == NULL)) {
        return NULL;
    }
    if (type != fmi2CoSimulation) {
        (void)refuse(&asked, "this model is for co-simulation");
    } else if ((guid == NULL) || (strcmp(guid, "@GUID@") != 0)) {
        (void)refuse(&asked, "the guid is of another model than this program");
    } else {
        m = (model_t *)host->allocateMemory(1U, sizeof *m);
        if (m == NULL) {
            (void)refuse(&asked, "there is no memory");
        } else {
            m->host = host;
            m->name = name;
            clear(m);
        }
    }
    return m;
}

FMI2_EXPORT void FMI2(fmi2FreeInstance)(fmi2Component c)
{
    model_t *m = (model_t *)c;
    if (m != NULL) {
        m->host->freeMemory(m);
    }
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetupExperiment)(
    fmi2Component c, fmi2Boolean given, fmi2Real tolerance, fmi2Real begin, fmi2Boolean ends,
    fmi2Real end)
{
    model_t *m = (model_t *)c;
    (void)given;
    (void)tolerance;
    (void)ends;
    (void)end;
    m->end = begin;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2EnterInitializationMode)(fmi2Component c)
{
    start((model_t *)c);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2ExitInitializationMode)(fmi2Component c)
{
    model_t *m = (model_t *)c;
    start(m);
    m->runs = true;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2Terminate)(fmi2Component c)
{
    ((model_t *)c)->runs = false;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2Reset)(fmi2Component c)
{
    clear((model_t *)c);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetReal)(
    fmi2Component c, const fmi2ValueReference at[], size_t n, fmi2Real value[])
{
    model_t *m = (model_t *)c;
    size_t k;
    for (k = 0U; k < n; k++) {
        const float *found = real_at(m, at[k]);
        if (found == NULL) {
            return refuse(m, "there is no such real variable");
        }
        value[k] = (double)*found;
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetReal)(
    fmi2Component c, const fmi2ValueReference at[], size_t n, const fmi2Real value[])
{
    model_t *m = (model_t *)c;
    size_t k;
    for (k = 0U; k < n; k++) {
        float *found = real_at(m, at[k]);
        if ((found == NULL) || (at[k] >= @INPUTS@U)) {
            return refuse(m, "a real variable that is set is no input");
        }
        *found = (float)value[k];
    }
    if (!m->runs) {
        start(m);
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetInteger)(
    fmi2Component c, const fmi2ValueReference at[], size_t n, fmi2Integer value[])
{
    const model_t *m = (const model_t *)c;
    size_t k;
    for (k = 0U; k < n; k++) {
        if (at[k] != 0U) {
            return refuse(m, "there is no such integer variable");
        }
        value[k] = (fmi2Integer)m->in.mode;
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetInteger)(
    fmi2Component c, const fmi2ValueReference at[], size_t n, const fmi2Integer value[])
{
    model_t *m = (model_t *)c;
    size_t k;
    for (k = 0U; k < n; k++) {
        if (at[k] != 0U) {
            return refuse(m, "there is no such integer variable");
        }
        m->in.mode = (uint32_t)value[k];
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetBoolean)(
    fmi2Component c, const fmi2ValueReference at[], size_t n, fmi2Boolean value[])
{
    const model_t *m = (const model_t *)c;
    size_t k;
    for (k = 0U; k < n; k++) {
        if (at[k] != 0U) {
            return refuse(m, "there is no such boolean variable");
        }
        value[k] = m->out.valid ? 1 : 0;
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetBoolean)(
    fmi2Component c, const fmi2ValueReference at[], size_t n, const fmi2Boolean value[])
{
    (void)at;
    (void)value;
    return (n == 0U) ? fmi2OK : refuse((const model_t *)c, "no boolean variable is an input");
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetString)(
    fmi2Component c, const fmi2ValueReference at[], size_t n, fmi2String value[])
{
    (void)at;
    (void)value;
    return (n == 0U) ? fmi2OK : refuse((const model_t *)c, "no variable is a string");
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetString)(
    fmi2Component c, const fmi2ValueReference at[], size_t n, const fmi2String value[])
{
    (void)at;
    (void)value;
    return (n == 0U) ? fmi2OK : refuse((const model_t *)c, "no variable is a string");
}

FMI2_EXPORT fmi2Status FMI2(fmi2DoStep)(
    fmi2Component c, fmi2Real now, fmi2Real length, fmi2Boolean kept)
{
    model_t *m = (model_t *)c;
    const double samples = length / PERIOD;
    long count;
    (void)kept;
    if (!m->runs) {
        return refuse(m, "a step before the initialization has ended");
    }
    if (!((now >= (m->end - (PART * PERIOD) - (1e-12 * m->end))) &&
          (now <= (m->end + (PART * PERIOD) + (1e-12 * m->end))))) {
        return refuse(m, "the step does not begin where the last one ended");
    }
    if (!((samples >= 0.5) && (samples <= MOST_SAMPLES))) {
        return refuse(m, "the communication step is no whole number of sample times");
    }
    count = (long)(samples + 0.5);
    if (!(((samples - (double)count) <= PART) && (((double)count - samples) <= PART))) {
        return refuse(m, "the communication step is no whole number of sample times");
    }
    for (; count > 0L; count--) {
        @OWN@_step(&m->in, &m->state, &m->out);
    }
    m->end = now + length;
    return fmi2OK;
}

/* What the description says that there is not. */
FMI2_EXPORT fmi2Status FMI2(fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    (void)state;
    return refuse((const model_t *)c, "states are not saved");
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state)
{
    (void)state;
    return refuse((const model_t *)c, "states are not saved");
}

FMI2_EXPORT fmi2Status FMI2(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state)
{
    (void)state;
    return refuse((const model_t *)c, "states are not saved");
}

FMI2_EXPORT fmi2Status FMI2(fmi2SerializedFMUstateSize)(
    fmi2Component c, fmi2FMUstate state, size_t *size)
{
    (void)state;
    (void)size;
    return refuse((const model_t *)c, "states are not saved");
}

FMI2_EXPORT fmi2Status FMI2(fmi2SerializeFMUstate)(
    fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size)
{
    (void)state;
    (void)bytes;
    (void)size;
    return refuse((const model_t *)c, "states are not saved");
}

FMI2_EXPORT fmi2Status FMI2(fmi2DeSerializeFMUstate)(
    fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state)
{
    (void)bytes;
    (void)size;
    (void)state;
    return refuse((const model_t *)c, "states are not saved");
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetDirectionalDerivative)(
    fmi2Component c, const fmi2ValueReference of[], size_t n, const fmi2ValueReference by[],
    size_t m, const fmi2Real along[], fmi2Real value[])
{
    (void)of;
    (void)n;
    (void)by;
    (void)m;
    (void)along;
    (void)value;
    return refuse((const model_t *)c, "there are no derivatives");
}

FMI2_EXPORT fmi2Status FMI2(fmi2SetRealInputDerivatives)(
    fmi2Component c, const fmi2ValueReference at[], size_t n, const fmi2Integer order[],
    const fmi2Real value[])
{
    (void)at;
    (void)n;
    (void)order;
    (void)value;
    return refuse((const model_t *)c, "inputs are held, not interpolated");
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetRealOutputDerivatives)(
    fmi2Component c, const fmi2ValueReference at[], size_t n, const fmi2Integer order[],
    fmi2Real value[])
{
    (void)at;
    (void)n;
    (void)order;
    (void)value;
    return refuse((const model_t *)c, "outputs are held: they have no derivatives");
}

FMI2_EXPORT fmi2Status FMI2(fmi2CancelStep)(fmi2Component c)
{
    return refuse((const model_t *)c, "a step ends at once");
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetStatus)(
    fmi2Component c, const fmi2StatusKind what, fmi2Status *value)
{
    (void)c;
    (void)what;
    (void)value;
    return fmi2Discard;
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetRealStatus)(
    fmi2Component c, const fmi2StatusKind what, fmi2Real *value)
{
    const model_t *m = (const model_t *)c;
    if (what != fmi2LastSuccessfulTime) {
        return fmi2Discard;
    }
    *value = m->end;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetIntegerStatus)(
    fmi2Component c, const fmi2StatusKind what, fmi2Integer *value)
{
    (void)c;
    (void)what;
    (void)value;
    return fmi2Discard;
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetBooleanStatus)(
    fmi2Component c, const fmi2StatusKind what, fmi2Boolean *value)
{
    (void)c;
    (void)what;
    (void)value;
    return fmi2Discard;
}

FMI2_EXPORT fmi2Status FMI2(fmi2GetStringStatus)(
    fmi2Component c, const fmi2StatusKind what, fmi2String *value)
{
    (void)c;
    (void)what;
    (void)value;
    return fmi2Discard;
}
"""
