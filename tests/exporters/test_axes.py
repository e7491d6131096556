"""Three axes in C: compilers agree with the replica, and no file says that it is proved."""

import numpy as np
import pytest

from nrs_design.controllers.axes_law import build_axes_law
from nrs_design.errors import DesignError
from nrs_design.exporters import axes
from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.program import Program
from nrs_design.exporters.vectors import make_vectors
from tests.exporters.programs import (
    CORTEX,
    LAWS,
    M4F,
    MACHINE,
    SEMIHOSTING,
    STRICT,
    built,
    compiler,
    run,
)

COUNT = 10_000
_MAIN = """\
#include "x_axes.h"
#include <stdio.h>
#include <string.h>
static const uint32_t cases[%d][14] = {
%s
};
int main(void)
{
    unsigned long wrong = 0UL;
    unsigned long k;
    for (k = 0UL; k < %dUL; k++) {
        nrs_x_axes_input_t in;
        nrs_x_axes_state_t state;
        nrs_x_axes_output_t out;
        const uint32_t *row = cases[k];
        (void)memcpy(&in, row, sizeof in);
        (void)memcpy(&state, &row[4], sizeof state);
        nrs_x_axes_step(&in, &state, &out);
        if (((out.valid ? 1U : 0U) != row[7]) || (memcmp(&out, &row[8], 12U) != 0) ||
            (memcmp(&state, &row[11], 12U) != 0)) {
            wrong++;
        }
    }
    (void)printf("%%lu cases differ\\n", wrong);
    return 0;
}
"""


@pytest.fixture
def program(sampled_export):
    return Program(sampled_export.record, LAWS["inertia"], CNames("x"))


def written(folder, program, count):
    law = build_axes_law(program.law)
    vectors = make_vectors(law, count)
    named = [
        "mode",
        *(v.name for v in law.inputs),
        *(f"before.{v.name}" for v in law.states),
        "valid",
        *law.outputs,
        *(f"after.{v.name}" for v in law.states),
    ]
    rows = vectors.rows[:, [vectors.columns.index(name) for name in named]]
    table = ",\n".join("{" + ", ".join(f"0x{n:x}U" for n in row) + "}" for row in rows.tolist())
    (folder / "x_axes.h").write_text(axes.header_text(program, law))
    (folder / "law.c").write_text(axes.source_text(program, law))
    (folder / "test.c").write_text(_MAIN % (count, table, count))
    assert 0.2 < np.mean(rows[:, 7]) < 0.98


@pytest.mark.slow
@pytest.mark.parametrize(
    ("count", "levels"),
    [(500, ("-O2",)), pytest.param(COUNT, ("-O0", "-O2", "-O3"), marks=pytest.mark.slow)],
)
def test_host_compilers_agree_with_the_replica(tmp_path, program, count, levels):
    gcc = compiler()
    written(tmp_path, program, count)
    for level in levels:
        sources = (tmp_path / "law.c", tmp_path / "test.c", "-lm", "-o", tmp_path / "test")
        built(gcc, *STRICT, level, *sources)
        assert run(tmp_path / "test").stdout == "0 cases differ\n"


@pytest.mark.slow
def test_an_emulated_cortex_agrees_with_the_replica(tmp_path, program):
    gcc, emulator = compiler("arm-none-eabi-gcc"), compiler("qemu-system-arm")
    written(tmp_path, program, COUNT)
    start = (M4F / "startup.c", "-T", M4F / "m4f.ld", "--specs=nosys.specs", "-nostartfiles")
    sources = (tmp_path / "law.c", tmp_path / "test.c", *start, "-lm")
    made = tmp_path / "test.elf"
    linked = run(gcc, *CORTEX, "-O2", "-std=c99", "-ffp-contract=off", *sources, "-o", made)
    assert linked.returncode == 0, linked.stderr
    done = run(emulator, *MACHINE, *SEMIHOSTING, "-kernel", made)
    assert (done.returncode, done.stderr) == (0, "0 cases differ\n")


def test_a_proof_of_one_axis_is_none_of_three(sampled_export):
    """The record is proved; these files say that they are not."""
    assert sampled_export.record.unproved is None
    files = axes.render(sampled_export)
    for content in files.values():
        words = " ".join(content.decode().replace("\n *", " ").split())
        assert f"verdict: UNPROVED: {axes.UNPROVED}" in words
        assert "verdict on the step of one axis: PROVED" in words
        assert words.count("PROVED") == 2
    assert axes.remarks(files) == (axes.UNPROVED,)


def test_a_law_with_more_than_admittances_is_refused(sampled_export, monkeypatch):
    monkeypatch.setattr(
        axes,
        "program_of",
        lambda export: Program(export.record, LAWS["static"], CNames("x")),
    )
    with pytest.raises(DesignError, match="no controller has a virtual inertia"):
        axes.render(sampled_export)
