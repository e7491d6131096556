import pytest

from nrs_design.errors import DesignError
from nrs_design.exporters.formats.fmu import compiler, shared_library
from tests.exporters.programs import compiler as found

SOURCES = {
    "x.h": "int twice(int n);\n",
    "x.c": '#include "x.h"\nint twice(int n) { return 2 * n; }\n',
}


def test_the_same_sources_are_the_same_bytes():
    cc = found("cc")
    first = shared_library(cc, SOURCES)
    assert first.startswith(b"\x7fELF")
    assert shared_library(cc, SOURCES) == first
    assert b"/tmp" not in first


def test_what_the_compiler_says_is_told():
    with pytest.raises(DesignError, match=r"does not compile the law: x\.c"):
        shared_library(found("cc"), {"x.c": "int main(\n"})


@pytest.mark.parametrize("other", [("Darwin", "arm64"), ("Linux", "aarch64"), ("Windows", "AMD64")])
def test_no_other_system_is_taken_for_linux_on_x86(monkeypatch, other):
    monkeypatch.setattr("platform.system", lambda: other[0])
    monkeypatch.setattr("platform.machine", lambda: other[1])
    assert compiler() is None
