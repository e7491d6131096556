"""Compiled C with a safety layer, along a run in which it is idle: every bit is that without it."""

import numpy as np

from nrs_design.controllers.replica import step
from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.formats.c import header_text, source_text
from nrs_design.exporters.formats.vectors import make_vectors
from nrs_design.exporters.header import header_lines
from nrs_design.exporters.self_test import program_macro, self_test
from tests.exporters.programs import STRICT, built, compiler, run
from tests.simulation.safe import LIMITS, Plants, law_of

SAMPLES = 400


def admissible(bare, layer):
    """Yield the cases of a run of the law without the layer, as the one with it must have them.

    The axis goes into tissue of 43 N m/rad, stops and leaves it, as fast as 0.1 rad/s.
    """
    plants = Plants(1, np.array([0.002]), np.random.default_rng(0), ends=False)
    states = {s.name: np.zeros(1, np.float32) for s in bare.states}
    spent = np.zeros(1, np.float32)
    for k in range(SAMPLES):
        hand = 0.1 * np.sin(2 * np.pi * k / SAMPLES)
        given = {
            "angle": plants.theta.astype(np.float32),
            "torque": (43 * plants.deflection()).astype(np.float32),
            "velocity_command": np.array([hand], np.float32),
            **states,
        }
        mode = np.ones(1, np.uint32)
        done = step(bare, mode, given)
        account = step(layer, mode, {**given, "spent": spent}).states["spent"]
        outputs = {**done.outputs, "withheld": np.zeros(1, np.float32)}
        before = {f"before.{n}": v for n, v in (states | {"spent": spent}).items()}
        after = {f"after.{n}": v for n, v in {**done.states, "spent": account}.items()}
        inputs = {value.name: given[value.name] for value in bare.inputs}
        yield {**inputs, **before, **outputs, **after}
        states, spent = dict(done.states), account
        *_, (plants.theta, plants.omega) = plants.move(done.outputs["command"].astype(float))


def test_along_an_admissible_run_no_bit_of_the_compiled_law_differs(tmp_path, sampled_export):
    layer, bare = law_of(), law_of(layer=False)
    cases = list(admissible(bare, layer))
    torques = [float(case["torque"][0]) for case in cases]
    assert 0.1 < max(torques) < float(LIMITS.torque)
    assert max(float(case["after.spent"][0]) for case in cases) > 1e-5
    columns = make_vectors(layer, 1).columns
    whole = {"mode": 1, "valid": 1}
    rows = np.array(
        [
            [whole[n] if n in whole else int(case[n].view(np.uint32)[0]) for n in columns]
            for case in cases
        ],
        np.uint32,
    )
    record = sampled_export.record
    names, about = CNames(record.spec.name), header_lines(record)
    (tmp_path / f"{names.spec}.h").write_text(header_text(record, layer, names))
    (tmp_path / "law.c").write_text(source_text(record, layer, names))
    for ending, content in self_test(layer, columns, rows, names, about).items():
        (tmp_path / f"{names.spec}{ending}").write_bytes(content)
    flag = f"-D{program_macro(names)}"
    sources = (tmp_path / "law.c", tmp_path / f"{names.spec}_test.c")
    built(compiler(), *STRICT, flag, "-O2", *sources, "-o", tmp_path / "test")
    done = run(tmp_path / "test")
    assert (done.returncode, done.stdout) == (
        0,
        f"{names.spec}: all {SAMPLES} cases are the same\n",
    )
