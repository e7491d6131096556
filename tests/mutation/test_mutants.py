"""The errors that are made, and the list of those that change nothing."""

import pytest

from tests.mutation.__main__ import PACKAGE, PROOF, listed
from tests.mutation.mutants import mutants
from tests.tables import rows


@pytest.mark.parametrize(("source", "changed"), rows(__file__, "test_what_is_changed"))
def test_what_is_changed(source, changed):
    assert [mutant.name for mutant in mutants(source)] == [f"module: {words}" for words in changed]


@pytest.mark.parametrize(
    ("returns", "given", "others"),
    [("bool", "a", ["True", "False"]), ("str | None", "a", ["None"]), ("int", "a", [])],
)
def test_other_answers_of_a_function(returns, given, others):
    names = [mutant.name for mutant in mutants(f"def f() -> {returns}:\n    return {given}")]
    assert names == [f"f: return {given} -> return {other}" for other in others]


def test_namesakes_are_numbered_and_functions_named():
    source = (
        "class A:\n    def f(self):\n        x = a + b\n    def g(self):\n        x = a + b, a + b"
    )
    assert [m.name for m in mutants(source) if "a + b -> a - b" in m.name] == [
        "A.f: a + b -> a - b",
        "A.g: a + b -> a - b",
        "A.g: a + b -> a - b #2",
    ]


def test_one_change_at_a_time(tmp_path):
    results = []
    for mutant in mutants("x = (1 + 2) * 3"):
        space = {}
        exec(mutant.compile(tmp_path / "x.py"), space)
        results.append(space["x"])
    # The product, the sum, and every number one more and one less.
    assert sorted(results) == sorted([3 // 3, -3, 12, 6, 12, 6, 12, 6])


def test_every_entry_of_the_list_is_a_mutant_with_a_reason():
    for module, reasons in listed().items():
        path = next(path for home in (PROOF, PACKAGE) if (path := home / f"{module}.py").exists())
        names = {mutant.name for mutant in mutants(path.read_text())}
        assert reasons.keys() <= names, module
        assert all(len(reason) > 10 for reason in reasons.values())
