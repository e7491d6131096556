"""Communication steps of a model by FMI 2.0, in C, and what it says that it has not.

For `nrs_design.exporters.fmu_source`, which puts the law in the places between two @.
"""

from __future__ import annotations

STEPS = """\
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
