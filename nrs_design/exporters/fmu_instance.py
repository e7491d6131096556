"""The instance of a model by FMI 2.0, in C: what it holds, how it begins and ends.

For `nrs_design.exporters.fmu_source`, which puts the law in the places between two @.
"""

from __future__ import annotations

INSTANCE = """\
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

"""
