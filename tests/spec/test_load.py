import json
from pathlib import Path
from typing import Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.errors import SpecError
from nrs_design.spec import SwitchedSystemSpec, load_spec, read_spec
from nrs_design.spec.document import hash_meaning, parse_document, to_data
from nrs_design.spec.load import SPEC_KINDS, model_of
from tests.support import COMMUTING, ROOT, spec_in, started

from .samples import SWITCHED


def test_read_spec_keeps_text_and_hash(tmp_path: Path) -> None:
    path = tmp_path / "any-name.txt"
    content = SWITCHED.replace("\n", "\r\n").encode()
    path.write_bytes(content)
    loaded = read_spec(path)
    assert loaded.path == path
    assert loaded.sha256 == hash_of(SWITCHED)
    assert loaded.text == content.decode()
    assert isinstance(loaded.spec, SwitchedSystemSpec)
    assert load_spec(str(path)) == loaded.spec


SAID = "kind: a\nb: [1, 'two', {c: d}]\n"
SAME = [
    "# c\nkind: a # c\n\nb: [1, 'two', {c: d}]\n",
    SAID.replace("\n", "\r\n"),
    "\ufeff".encode().decode("utf-8-sig") + SAID,
    "{kind: a, b: [1, two, {c: d}]}",
    "kind: 'a'\nb:\n- \"1\"\n- two\n- c: d\n",
    "kind: a\nb: [!r, two, {c: d}]\n".replace("!r", '"\\x31"'),
]


def hash_of(text: str) -> str:
    return hash_meaning(to_data(parse_document(text)))


@pytest.mark.parametrize("text", SAME)
def test_the_hash_does_not_depend_on_how_it_is_written(text: str) -> None:
    assert hash_of(text) == hash_of(SAID)


TREES = st.recursive(
    st.text(st.characters(codec="ascii", min_codepoint=32), min_size=1, max_size=4),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text("ab:", min_size=1), inner),
    max_leaves=6,
)


@given(TREES, TREES)
def test_equal_hashes_mean_equal_documents(one: object, other: object) -> None:
    same = hash_of(json.dumps(one, indent=1)) == hash_of(json.dumps(other, indent=1))
    # The order of keys counts, as it does in the text.
    assert same is (json.dumps(one) == json.dumps(other))


def test_error_names_the_file(tmp_path: Path) -> None:
    path = spec_in(tmp_path, SWITCHED.replace("name: sample", "name: -"), "a")
    with pytest.raises(SpecError) as caught:
        load_spec(path)
    assert caught.value.path == path
    assert str(caught.value).startswith(f"{path}:2:7: ")


def printed(code: str) -> list[str]:
    """Return the lines that a program prints."""
    return started("-c", code, cwd=ROOT).stdout.splitlines()


def test_import_is_light() -> None:
    heavy = ["numpy", "scipy", "control", "matplotlib", "cvxpy", "clarabel", "jinja2", "rich"]
    code = (
        "import sys, nrs_design.spec, nrs_design.spec.describe, nrs_design.spec.templates\n"
        f"print([name for name in {heavy} if name in sys.modules])"
    )
    assert printed(code) == ["[]"]


def test_a_spec_pays_for_the_models_of_its_kind_only() -> None:
    code = (
        "import sys, nrs_design.spec\n"
        "print('pydantic' in sys.modules)\n"
        f"nrs_design.spec.read_spec({str(COMMUTING)!r})\n"
        "print(*(name for name in sys.modules if name.startswith('nrs_design.spec.')))"
    )
    first, loaded = printed(code)
    assert first == "False"
    assert "nrs_design.spec.switched_system" in loaded
    for other in ("interaction", "controllers", "environment", "robot"):
        assert f"nrs_design.spec.{other}" not in loaded.split()


def test_every_kind_has_its_model() -> None:
    kinds = {kind: model_of(kind).model_fields["kind"].annotation for kind in SPEC_KINDS}
    assert kinds == {kind: Literal[kind] for kind in SPEC_KINDS}
