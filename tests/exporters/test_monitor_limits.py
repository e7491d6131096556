"""The region in the monitor: silent inside only, and what is not known counts as the worst."""

import ctypes
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.controllers.replica import StepProgram
from nrs_design.exporters.deployed import compare_deployed
from nrs_design.exporters.export import Execution, export_design
from nrs_design.exporters.formats.c import render as render_c
from nrs_design.exporters.formats.monitor import list_violations, render
from nrs_design.exporters.monitor_limits import ROOM, MonitoredRegion, monitor_limits, region_of
from nrs_design.exporters.program import program_of
from nrs_design.proof.evidence import SaturatedEllipsoid
from nrs_design.spec import read_spec
from nrs_design.spec.sampling import SamplingSpec
from tests.exporters.monitored import Input, Monitor
from tests.exporters.programs import STRICT, built, compiler, write_formats
from tests.loop.test_sampled_saturation import IMPEDANCE, KM, TAU

STIFFNESS = 747.1461 * 0.24**2


def exported(folder, text):
    file = folder / "s.nrs.yaml"
    file.write_text(text, encoding="utf-8")
    return export_design(read_spec(file), execution=Execution())


@pytest.fixture(scope="module")
def export(tmp_path_factory):
    head, _, tail = IMPEDANCE.partition("  withdrawal:")
    text = head + "contact: losable" + tail.partition("contact: losable")[2]
    # Torques of the region are beyond the limit of the example.
    text = text.replace("torque: 0.3 N*m", "torque: 9 N*m")
    return exported(tmp_path_factory.mktemp("region"), text)


def test_the_region_is_in_the_monitor_that_verify_compares_with(tmp_path, export):
    write_formats(tmp_path, export, ("c", "monitor"))
    found = compare_deployed(tmp_path, export.spec, export.certificate)
    assert (len(found.compared), found.differences) == (6, ())


LAW = ("reference", "error_before", "velocity")


class Law(ctypes.Structure):
    _fields_ = [(name, ctypes.c_float) for name in LAW]


class Inputs(ctypes.Structure):
    _fields_ = [*Input._fields_, ("law", Law)]


class Watching(Monitor):
    reads = Inputs

    def __init__(self, folder, export):
        program, own = program_of(export), {**render_c(export), **render(export)}
        self.law, name = program.law, program.names.spec
        sources = {f"{name}{ending}": text.decode() for ending, text in own.items()}
        for key, text in sources.items():
            (folder / key).write_text(text)
        built(compiler(), *STRICT, "-c", folder / f"{name}_monitor.c", "-o", folder / "m.o")
        super().__init__(folder, sources)


def runs(monitor, delta, samples=80):
    """Yield what the monitor says along a run from rest at a deflection, and the state."""
    program, law = StepProgram(monitor.law), monitor.law
    names = [value.name for value in law.states]
    states = dict.fromkeys(names, np.float32(0))
    # The angle counts from the surface.
    angle, omega, before = delta, 0.0, STIFFNESS * delta
    states["reference"] = np.float32(angle)
    decay = np.exp(-0.002 / TAU)
    monitor.begin()
    for _ in range(samples):
        force = STIFFNESS * max(angle, 0.0)
        given = {"angle": angle, "torque": before} | states
        values = [np.float32(given.get(value.name, 0.0)) for value in law.values]
        (command,), after, _ = program.step(0, values)
        known = Law(*(states[name] for name in LAW))
        said = monitor.step(
            mode=0, age=1, angle=angle, torque=before, command=command * 0.999, law=known
        )
        error = float(states["reference"]) - angle
        yield (
            said,
            {
                "e [rad]": error,
                "omega [rad/s]": omega,
                "e before [rad]": float(states["error_before"]),
                "vm [rad/s]": float(states["velocity"]),
                "F 1 before [N*m]": before,
                "delta [rad]": max(angle, 0.0),
            },
        )
        u = float(command) * 0.999
        way = TAU * (1 - decay) * (omega - KM * u) + 0.002 * KM * u
        omega = decay * omega + KM * (1 - decay) * u
        before, angle = force, angle + way
        states = dict(zip(names, after, strict=True))


def test_silence_means_inside(tmp_path, export):
    """From deflections on both sides of the region: never silent outside, and not for nothing."""
    system = export.certificate.system
    evidence = next(s for s in export.certificate.statements if isinstance(s, SaturatedEllipsoid))
    Q = np.ldexp(np.array(evidence.Q, dtype=float), -evidence.denominator_log2)
    monitor = Watching(tmp_path, export)
    told = silent = 0
    for force in (*np.linspace(0.05, 0.5, 6), *np.linspace(0.6, 3.0, 6)):
        for k, (said, state) in enumerate(runs(monitor, force / STIFFNESS)):
            w = np.array([state[name] for name in system.states])
            V = float(w @ Q @ w)
            if said == "SATURATION":
                break
            assert said in ("NONE", "REGION", "FORCE")
            if said != "NONE":
                told += said == "REGION"
                # Not much is lost to what is not known.
                assert said == "FORCE" or V > 0.7
                break
            silent += 1
            assert k < 1 or V <= 1
    assert told >= 1
    assert silent > 200


def test_the_numbers_are_on_the_safe_side(export):
    program = program_of(export)
    region = region_of(export, program.law)
    assert isinstance(region, MonitoredRegion)
    evidence = next(s for s in export.certificate.statements if isinstance(s, SaturatedEllipsoid))
    Q = np.ldexp(np.array(evidence.Q, dtype=float), -evidence.denominator_log2)
    U = np.array([[float(v) for v in row] for row in region.rows])
    scale = np.sqrt(np.diag(Q))
    more = (U.T @ U - Q) / np.outer(scale, scale)
    assert np.linalg.eigvalsh(more)[0] > 0
    assert np.abs(more).max() < 3 * ROOM
    E = np.exp(-0.002 / TAU)
    assert region.ways[0] <= Fraction(E / (TAU * (1 - E))) * (1 + Fraction(1, 2**40))
    assert region.ways[1] >= Fraction(E / (TAU * (1 - E))) * (1 - Fraction(1, 2**40))
    low, high = 720.56 * 0.24**2, 768.17 * 0.24**2
    assert region.stiffness[0] <= low < high <= region.stiffness[1]


def test_what_is_not_monitored_is_said(tmp_path, export):
    law, system = program_of(export).law, export.certificate.system
    late = replace(export, spec=changed(export.spec, latency="0.4 ms"))
    uneven = replace(export, spec=changed(export.spec, jitter="0.1 ms"))
    alone = replace(export.certificate, statements=export.certificate.statements[:1])
    unknown = replace(export.certificate, system=replace(system, states=("x", *system.states[1:])))
    for other, said in (
        (replace(export, certificate=None), "has no `initial_force`"),
        (replace(export, certificate=alone), "has no `initial_force`"),
        (late, "commands take effect late"),
        (uneven, "periods are not of one length"),
        (replace(export, certificate=unknown), "counts from a rest"),
    ):
        assert said in region_of(other, law)
        limits = monitor_limits(other, law)
        assert limits.region is None
        assert any(said in line for line in limits.left_out)
        assert "SATURATION" in list_violations(limits)
    assert "SATURATION" not in list_violations(monitor_limits(export, law))


def changed(spec, **sampling):
    given = {"period": "2 ms", "delay": 1, **sampling}
    return spec.model_copy(update={"sampling": SamplingSpec.model_validate(given)})
