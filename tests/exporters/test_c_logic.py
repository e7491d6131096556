"""The mode logic in C: step by step what the replica does, and every number of it deployed."""

import json
import re
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.controllers.shipped import shipped_law
from nrs_design.exporters.build import build_unproved
from nrs_design.exporters.c_names import CNames, literal
from nrs_design.exporters.formats.c import header_text, source_text
from nrs_design.exporters.formats.vectors import make_vectors, vectors_text
from nrs_design.exporters.logic_cases import COUNT, logic_document
from nrs_design.exporters.self_test import program_macro, self_test
from nrs_design.pipeline import run_design
from nrs_design.spec import read_spec
from tests.exporters.programs import STRICT, built, check_with_misra, compiler, emulated, run
from tests.support import ROOT

PERIOD = Fraction(1, 500)
MAIN = """
#include "{name}.h"
#include <stdio.h>
#include <string.h>
static const uint32_t cases[{count}][{signals}] = {{
{rows}
}};
static float from_bits(uint32_t bits)
{{
    float value;
    (void)memcpy(&value, &bits, sizeof value);
    return value;
}}
int main(void)
{{
    {own}_logic_t logic;
    unsigned long k;
    {own}_logic_init(&logic);
    for (k = 0UL; k < {count}UL; k++) {{
        {own}_signals_t seen;
        uint32_t mode;
        {reads}
        mode = {own}_logic_step(&seen, &logic);
        (void)printf("%lu %lu\\n", (unsigned long)mode, (unsigned long)logic.held);
    }}
    logic.mode = 99U;
    logic.held = UINT32_MAX;
    (void)printf("%lu\\n", (unsigned long){own}_logic_step(&(const {own}_signals_t){{0}}, &logic));
    logic.held = UINT32_MAX;
    (void){own}_logic_step(&(const {own}_signals_t){{0}}, &logic);
    (void)printf("%d\\n", logic.held == UINT32_MAX);
    return 0;
}}
"""


@pytest.fixture(scope="module", params=["insertion-by-sign", "force-by-threshold"])
def shipped(request):
    found = run_design(read_spec(ROOT / f"docs/examples/{request.param}.nrs.yaml"))
    law = shipped_law(found.spec, found.design, PERIOD)
    record = build_unproved(found.loaded, found.design, "a test", PERIOD, None)
    return record, law, CNames(found.spec.name)


def signals(logic, count):
    """Draw signals that stay for a while, some of them no numbers."""
    rng = np.random.default_rng(4)
    drawn = rng.uniform(-0.3, 0.5, (count // 20, len(logic.signals)))
    drawn[rng.random(drawn.shape) < 0.05] = np.nan
    drawn[rng.random(drawn.shape) < 0.02] = np.inf
    return np.repeat(drawn, 20, axis=0).astype(np.float32)


@pytest.fixture
def program(tmp_path, shipped):
    """Write the law and a program that prints what its logic does; what it should print."""
    record, law, names = shipped
    values = signals(law.logic, 4000)
    rows = ",\n".join(
        "{" + ", ".join(f"0x{bits:x}U" for bits in row) + "}" for row in values.view(np.uint32)
    )
    reads = " ".join(
        f"seen.{name} = from_bits(cases[k][{i}]);" for i, name in enumerate(law.logic.signals)
    )
    main = MAIN.format(
        name=names.spec,
        own=names.lower,
        rows=rows,
        reads=reads,
        count=len(values),
        signals=len(law.logic.signals),
    )
    (tmp_path / f"{names.spec}.h").write_text(header_text(record, law, names))
    (tmp_path / "law.c").write_text(source_text(record, law, names))
    (tmp_path / "main.c").write_text(main)
    return [*steps_of(law.logic, values), str(law.logic.start), "1"]


def steps_of(logic, values):
    mode, held, steps, switches = logic.start, 0, [], 0
    for row in values:
        before = mode
        seen = dict(zip(logic.signals, map(float, row), strict=True))
        mode, held = logic.step(mode, held, seen)
        steps.append(f"{mode} {held}")
        switches += mode != before
    assert switches > 10
    return steps


def test_compiled_logic_agrees_with_the_replica(tmp_path, program):
    gcc = compiler()
    for level in ("-O0", "-O2"):
        made = tmp_path / f"main{level}"
        built(gcc, *STRICT, level, tmp_path / "law.c", tmp_path / "main.c", "-o", made)
        assert run(made).stdout.splitlines() == program


@pytest.mark.slow
def test_an_emulated_cortex_agrees_with_the_replica(tmp_path, program):
    said = emulated(tmp_path, tmp_path / "law.c", tmp_path / "main.c").removeprefix("0: ")
    assert said.splitlines() == program


@pytest.mark.slow
def test_cppcheck_with_misra_is_content(tmp_path, shipped):
    record, law, names = shipped
    (tmp_path / f"{names.spec}.h").write_text(header_text(record, law, names))
    (tmp_path / "law.c").write_text(source_text(record, law, names))
    check_with_misra(tmp_path / "law.c")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("", ""),
        ("logic->held >=", "logic->held >"),
        (" >= NRS", " > NRS"),
        ("logic->held++", "logic->held += 2U"),
        ("? logic->mode", "? 0U"),
        ("logic->mode = after", "logic->mode = before"),
        ("return after", "return before"),
    ],
)
def test_the_self_test_runs_the_logic_too(tmp_path, shipped, old, new):
    """After the law, which is right: every slip in the logic is one of its own cases."""
    record, law, names = shipped
    vectors = make_vectors(law, 20)
    files = self_test(law, vectors.columns, vectors.rows, names, ())
    source = source_text(record, law, names)
    assert old in source
    (tmp_path / f"{names.spec}.h").write_text(header_text(record, law, names))
    (tmp_path / "law.c").write_text(source.replace(old, new) if old else source)
    for ending, content in files.items():
        (tmp_path / f"{names.spec}{ending}").write_bytes(content)
    sources = (tmp_path / "law.c", tmp_path / f"{names.spec}_test.c", "-o", tmp_path / "program")
    built(compiler(), *STRICT, f"-D{program_macro(names)}", *sources)
    said = run(tmp_path / "program").stdout
    if old:
        (index,) = map(int, re.findall(r"case (\d+) differs", said))
        assert index >= len(vectors.rows)
    else:
        assert said == f"{names.spec}: all {len(vectors.rows) + COUNT} cases are the same\n"


def test_every_number_of_the_logic_is_in_the_header(shipped):
    """`verify --deployed` compares all of them."""
    record, law, names = shipped
    exported = json.loads(vectors_text(law, make_vectors(law, 3), ()))
    assert exported["logic"] == logic_document(law.logic)
    text = header_text(record, law, names)
    macros = re.findall(rf"#define {names.upper}_LOGIC_\w+ (\S+)", text)
    bounds = [literal(b.threshold) for s in law.logic.switches for b in s.bounds]
    stays = [f"{number}U" for number in (law.logic.start, *law.logic.stays)]
    assert sorted(macros) == sorted([*bounds, *stays])
    assert "The proof does not rest on the signals" in " ".join(text.replace("\n *", " ").split())
