"""Exported C: what real compilers make of it is, bit for bit, what NumPy's float32 makes of it."""

import re

import numpy as np
import pytest

from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.formats.c import header_text, source_text
from nrs_design.exporters.formats.vectors import make_vectors
from nrs_design.exporters.header import header_lines
from nrs_design.exporters.self_test import program_macro, self_test
from tests.exporters.programs import (
    CORTEX,
    LAWS,
    STRICT,
    built,
    check_with_misra,
    compiler,
    emulated,
    run,
)
from tests.support import thinned

COUNT = 10_000
SAME = f"soft-tissue: all {COUNT} cases are the same\n"


def written(folder, law, export, count=COUNT):
    """Write header, source and test of a law; the flag that gives the test a `main` comes back."""
    record = export.record
    names = CNames(record.spec.name)
    vectors = make_vectors(law, count)
    (folder / f"{names.spec}.h").write_text(header_text(record, law, names))
    (folder / "law.c").write_text(source_text(record, law, names))
    tests = self_test(law, vectors.columns, vectors.rows, names, header_lines(record))
    for ending, content in tests.items():
        (folder / f"{names.spec}{ending}").write_bytes(content)
    (folder / "test.c").write_bytes(tests["_test.c"])
    return f"-D{program_macro(names)}"


SHAPES = thinned(sorted(LAWS, key=lambda shape: shape != "limits"), 1)


@pytest.mark.parametrize("shape", SHAPES)
def test_host_compilers_agree_with_the_replica(tmp_path, sampled_export, shape):
    """10,000 states, a part of them with NaN, infinities, subnormal numbers and random bits."""
    gcc = compiler()
    flag = written(tmp_path, LAWS[shape], sampled_export)
    built(gcc, *STRICT, flag, "-O0", "-c", tmp_path / "test.c", "-o", tmp_path / "test.o")
    for level in ("-O0", "-O2", "-O3"):
        program = tmp_path / f"test{level}"
        built(gcc, *STRICT, level, tmp_path / "law.c", tmp_path / "test.o", "-o", program)
        done = run(program)
        assert (done.returncode, done.stdout) == (0, SAME)


def test_an_integral_is_cut_off_bit_for_bit(tmp_path, sampled_export):
    """Of the states of the vectors many are beyond the clamp, and one is at it to the bit."""
    gcc, law = compiler(), LAWS["clamped"]
    vectors = make_vectors(law, COUNT)
    limit = np.float32(float(law.coefficient["integral_limit"].values[0])).view(np.uint32)
    after = vectors.rows[:, vectors.columns.index("after.integral")]
    assert (after == limit).sum() > 100
    flag = written(tmp_path, law, sampled_export)
    program = tmp_path / "test"
    sources = (tmp_path / "law.c", tmp_path / "test.c")
    built(gcc, *STRICT, flag, "-O2", *sources, "-o", program)
    assert run(program).stdout == SAME


@pytest.mark.parametrize("shape", SHAPES)
def test_an_emulated_cortex_agrees_with_the_replica(tmp_path, sampled_export, shape):
    """The same states on an emulated STM32F405, compiled as for the robot."""
    flag = written(tmp_path, LAWS[shape], sampled_export)
    assert emulated(tmp_path, tmp_path / "law.c", flag, tmp_path / "test.c") == f"0: {SAME}"


def test_the_law_links_to_nothing(tmp_path, sampled_export):
    """No heap, no libm, and on the processor no arithmetic of doubles by library."""
    written(tmp_path, LAWS["limits"], sampled_export, 1)
    own = CNames(sampled_export.record.spec.name).lower
    names = [f"{own}_init", f"{own}_step"]
    for gcc, nm, flags in (("gcc", "nm", ()), ("arm-none-eabi-gcc", "arm-none-eabi-nm", CORTEX)):
        built(compiler(gcc), *flags, *STRICT, "-O2", "-c", tmp_path / "law.c", "-o", tmp_path / "o")
        symbols = run(compiler(nm), "-g", tmp_path / "o").stdout.split("\n")
        assert [line.split()[-2:] for line in symbols if line] == [["T", name] for name in names]


def test_cppcheck_with_misra_is_content(tmp_path, sampled_export):
    written(tmp_path, LAWS["filter and spring"], sampled_export, 1)
    check_with_misra(tmp_path / "law.c")


@pytest.mark.slow
def test_every_slip_in_the_code_is_noticed(tmp_path, sampled_export):
    """One line at a time: another operation, another operand or another bit fails the vectors."""
    gcc = compiler()
    flag = written(tmp_path, LAWS["filter and spring"], sampled_export, 300)
    source = (tmp_path / "law.c").read_text()
    header = (tmp_path / f"{sampled_export.record.spec.name}.h").read_text()
    built(gcc, *STRICT, flag, "-O0", "-c", tmp_path / "test.c", "-o", tmp_path / "test.o")
    slips = 0
    for old, new in slips_of(source):
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
    ("flags", "said"),
    [
        (("-ffast-math",), "-ffast-math"),
        (("-ffinite-math-only",), "-ffinite-math-only"),
        (("-funsafe-math-optimizations",), "parts of it"),
        (("-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math"), "parts of it"),
        (("-freciprocal-math",), "parts of it"),
    ],
)
def test_fast_arithmetic_is_refused_by_the_compiler(tmp_path, sampled_export, flags, said):
    """Where guards would be left out, and where sums would be reordered."""
    gcc = compiler()
    written(tmp_path, LAWS["inertia"], sampled_export, 1)
    done = run(gcc, "-std=c99", *flags, "-c", tmp_path / "law.c", "-o", tmp_path / "o")
    assert done.returncode != 0
    assert said in done.stderr
