"""Exported C: what real compilers make of it is, bit for bit, what NumPy's float32 makes of it."""

import re

import numpy as np
import pytest

from nrs_design.exporters.self_test import draw_cases
from nrs_design.exporters.text import CNames
from tests.exporters.programs import (
    LAWS,
    STRICT,
    built,
    check_that_it_calls_nothing,
    check_with_misra,
    compiler,
    emulated,
    run,
    write_law,
)
from tests.support import thinned
from tests.tables import rows

COUNT = 10_000
SAME = f"soft-tissue: all {COUNT} cases are the same\n"


SHAPES = thinned(sorted(LAWS, key=lambda shape: shape != "limits"), 1)


@pytest.mark.parametrize("shape", SHAPES)
def test_host_compilers_agree_with_the_replica(tmp_path, sampled_export, shape):
    """10,000 states, a part of them with NaN, infinities, subnormal numbers and random bits."""
    gcc, law = compiler(), LAWS[shape]
    source, test, flag = write_law(tmp_path, sampled_export.record, law, draw_cases(law, COUNT))
    built(gcc, *STRICT, flag, "-O0", "-c", test, "-o", tmp_path / "test.o")
    for level in ("-O0", "-O2", "-O3"):
        program = tmp_path / f"test{level}"
        built(gcc, *STRICT, level, source, tmp_path / "test.o", "-o", program)
        done = run(program)
        assert (done.returncode, done.stdout) == (0, SAME)


@pytest.mark.parametrize("shape", LAWS)
def test_cases_reach_every_corner(shape):
    """Every kind of number that a memory can hold, in inputs and states; most steps are valid."""
    cases = draw_cases(LAWS[shape])
    valid = cases.rows[:, cases.columns.index("valid")]
    assert 0.6 < valid.mean() < 0.95
    assert (cases.rows[:, 0] == len(LAWS[shape].modes)).sum() > 10
    for i, name in enumerate(cases.columns):
        if name not in ("mode", "valid", *LAWS[shape].outputs) and not name.startswith("after."):
            numbers = cases.rows[:, i].view(np.float32)
            assert np.isnan(numbers).any()
            assert np.isinf(numbers).any()
            assert ((numbers != 0) & (np.abs(numbers) < np.finfo(np.float32).tiny)).any()


def test_cases_saturate_and_do_not():
    """In both directions, the command of the hand and that of the motor."""
    law = LAWS["limits"]
    cases = draw_cases(law)
    valid = cases.rows[:, cases.columns.index("valid")] == 1
    for name, limit in (("velocity_command", "velocity_limit"), ("command", "command_limit")):
        numbers = cases.rows[valid, cases.columns.index(name)].view(np.float32)
        largest = float(law.coefficient[limit].values[0])
        for beyond in (numbers >= largest, numbers <= -largest, np.abs(numbers) < largest):
            assert beyond.sum() > 10


def test_an_integral_is_cut_off_in_many_cases():
    law = LAWS["clamped"]
    cases = draw_cases(law, COUNT)
    limit = np.float32(float(law.coefficient["integral_limit"].values[0])).view(np.uint32)
    after = cases.rows[:, cases.columns.index("after.integral")]
    assert (after == limit).sum() > 100


@pytest.mark.parametrize("shape", SHAPES)
def test_an_emulated_cortex_agrees_with_the_replica(tmp_path, sampled_export, shape):
    """The same states on an emulated STM32F405, compiled as for the robot."""
    law = LAWS[shape]
    source, test, flag = write_law(tmp_path, sampled_export.record, law, draw_cases(law, COUNT))
    assert emulated(tmp_path, source, flag, test) == f"0: {SAME}"


def test_the_law_links_to_nothing(tmp_path, sampled_export):
    law, own = LAWS["limits"], CNames(sampled_export.record.spec.name).lower
    source, *_ = write_law(tmp_path, sampled_export.record, law, draw_cases(law, 1))
    check_that_it_calls_nothing(tmp_path, source, [f"{own}_init", f"{own}_step"])


def test_cppcheck_with_misra_is_content(tmp_path, sampled_export):
    law = LAWS["filter and spring"]
    check_with_misra(write_law(tmp_path, sampled_export.record, law, draw_cases(law, 1))[0])


@pytest.mark.slow
def test_every_slip_in_the_code_is_noticed(tmp_path, sampled_export):
    """One line at a time: another operation, another operand or another bit fails the cases."""
    gcc, law = compiler(), LAWS["filter and spring"]
    source, test, flag = write_law(tmp_path, sampled_export.record, law, draw_cases(law, 300))
    header = source.with_suffix(".h").read_text()
    built(gcc, *STRICT, flag, "-O0", "-c", test, "-o", tmp_path / "test.o")
    slips = 0
    for old, new in slips_of(source.read_text()):
        slips += 1
        (tmp_path / "slip.c").write_text(new)
        linked = (tmp_path / "slip.c", tmp_path / "test.o", "-o", tmp_path / "slip")
        assert run(gcc, "-O0", "-std=c99", *linked).returncode == 0, old
        assert run(tmp_path / "slip").returncode == 1, old
    assert slips > 30
    assert header.count("#define") > 15


def slips_of(source):
    """Yield lines, and the source with another in their place."""
    _, _, body = source.partition("_step(")
    head = source[: len(source) - len(body)]
    for line in body.splitlines():
        swapped = None
        if re.search(r" (\+|-|\*) ", line) and "const float" in line:
            for old, new in ((" + ", " - "), (" - ", " + "), (" * ", " + ")):
                if old in line:
                    swapped = line.replace(old, new)
        elif "is_within(" in line:
            swapped = re.sub(r"is_within\([^)]*\)", "true", line)
        elif "= 0.0F" in line or "saturated(" in line:
            swapped = line.replace("0.0F", "1.0F").replace("saturated(", "0.5F * saturated(")
        elif re.search(r"(state|out)->\w+ = \w+;", line):
            swapped = "(void)0;"
        if swapped is not None:
            yield line, head + body.replace(line, swapped, 1)


@pytest.mark.parametrize(
    ("flags", "said"), rows(__file__, "test_fast_arithmetic_is_refused_by_the_compiler")
)
def test_fast_arithmetic_is_refused_by_the_compiler(tmp_path, sampled_export, flags, said):
    """Where guards would be left out, and where sums would be reordered."""
    law = LAWS["inertia"]
    source, *_ = write_law(tmp_path, sampled_export.record, law, draw_cases(law, 1))
    done = run(compiler(), "-std=c99", *flags, "-c", source, "-o", tmp_path / "o")
    assert done.returncode != 0
    assert said in done.stderr


# What a robot does before it moves: the exit code says which case is the first to differ.
MAIN = """#include "soft-tissue_test.h"
int main(void) { return (int)nrs_soft_tissue_self_test() + 1; }
"""


def written(folder, export, wrong=None):
    """Write a law with 60 cases, and another result in some of them."""
    cases = draw_cases(LAWS["limits"], 60)
    for row, column in wrong or []:
        cases.rows[row, cases.columns.index(column)] ^= 1
    (folder / "main.c").write_text(MAIN)
    return folder / "main.c", *write_law(folder, export.record, LAWS["limits"], cases)


@pytest.mark.parametrize(("wrong", "first"), rows(__file__, "test_the_first_case_that_differs"))
def test_the_first_case_that_differs(tmp_path, sampled_export, wrong, first):
    *sources, _ = written(tmp_path, sampled_export, wrong)
    built(compiler(), *STRICT, "-O1", *sources, "-o", tmp_path / "program")
    assert run(tmp_path / "program").returncode == first + 1


@pytest.mark.parametrize("wrong", [[], [(17, "command"), (30, "valid")]])
def test_on_an_emulated_processor(tmp_path, sampled_export, wrong):
    main, *others, _ = written(tmp_path, sampled_export, wrong)
    assert emulated(tmp_path, main, *others) == f"{18 if wrong else 0}: "


def test_the_program_around_it(tmp_path, sampled_export):
    _, *files = written(tmp_path, sampled_export, [(17, "valid")])
    built(compiler(), *STRICT, *files, "-o", tmp_path / "program")
    done = run(tmp_path / "program")
    assert (done.returncode, done.stdout) == (1, "case 17 differs\n")
