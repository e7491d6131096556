"""Reading and setting the variables of a model by FMI 2.0, in C.

For `nrs_design.exporters.fmu_source`, which puts the law in the places between two @.
"""

from __future__ import annotations

VALUES = """\
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

"""
