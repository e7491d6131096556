"""A deployed co-simulation model against a certificate: one bit, one name, one unit."""

import io
import re
import zipfile

import pytest

from nrs_design.exporters.compiled import compiler
from nrs_design.exporters.cosimulation import FMI2, contents, library_of, packed
from nrs_design.exporters.deployed_model import model_differences
from nrs_design.exporters.program import program_of

XML = "modelDescription.xml"


@pytest.fixture(scope="module")
def entries(sampled_export):
    return contents(program_of(sampled_export), FMI2, None)


@pytest.fixture
def differences(sampled_export, entries):
    def compare(name=None, change=None, **other):
        found = dict(entries)
        if name is not None:
            text = change(found[name].decode())
            assert text != found[name].decode()
            found[name] = text.encode()
        return [*model_differences(packed(found | other), sampled_export)]

    return compare


def replaced(old, new):
    return lambda text: text.replace(old, new, 1)


def test_what_was_exported_has_no_difference(differences, entries):
    assert differences() == []
    assert differences("documentation/index.html", lambda text: text + "more") == []
    assert differences(XML, lambda text: re.sub(r'Tool="[^"]*"', 'Tool="another"', text)) == []
    for name in entries:
        if name.endswith((".h", ".c")):
            assert differences(name, replaced("*/", "or so */")) == []


def test_a_library_is_what_the_sources_make_here(differences, sampled_export, monkeypatch):
    """A simulator runs it, and not the sources beside it."""
    program = program_of(sampled_export)
    name = library_of(program, FMI2)
    compile_with = compiler()
    assert compile_with is not None
    own = contents(program, FMI2, compile_with)[name]
    assert differences(**{name: own}) == []
    (found,) = differences(**{name: own[:-1] + bytes([own[-1] ^ 1])})
    assert found.startswith(f"{name} is not what ")
    for other in ("binaries/linux64/x.so", "binaries/win64/x.dll", f"{name}.so"):
        assert differences(**{other: own}) == [f"{other} is not in an export"]
    monkeypatch.setattr("nrs_design.exporters.deployed_model.compiler", lambda: None)
    (found,) = differences(**{name: own})
    assert "no compiler cc" in found


def test_one_bit(differences, entries):
    """Of each coefficient and limit, and of the sample time and the GUID."""
    (header,) = (name for name in entries if name.endswith(".h"))
    for line in entries[header].decode().splitlines():
        if match := re.match(r"#define (\w+) (0x1\S*F|\d+U)", line):
            number = match[2]
            other = number.replace("p", "1p", 1) if "p" in number else f"1{number}"
            (found,) = differences(header, replaced(f"{match[1]} {number}", f"{match[1]} {other}"))
            assert match[1] in found
    for old, new in (('guid="{', 'guid="{0'), ('stepSize="0.002"', 'stepSize="0.001"')):
        assert len(differences(XML, replaced(old, new))) == 1
    assert len(differences("sources/fmu.c", replaced("PERIOD 0.002", "PERIOD 0.0020000001"))) == 1


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('name="angle"', 'name="torque"'),
        ('unit="rad"', 'unit="deg"'),
        ('unit="N*m"', 'unit="N*mm"'),
        ('s="-2"', 's="-1"'),
        ("0 insertion", "1 insertion"),
        ('valueReference="1"', 'valueReference="2"'),
        ('causality="input"', 'causality="local"'),
        ("PROVED", "proved"),
        ('start="0"', 'start="1"'),
        ("</ModelVariables>", '<ScalarVariable name="x"/></ModelVariables>'),
    ],
)
def test_one_name_or_unit(differences, old, new):
    assert differences(XML, replaced(old, new))


def test_sources_are_compared(differences, entries):
    for name in entries:
        if name.endswith(".c"):
            assert differences(name, replaced(" + ", " - ") if "fmu" not in name else str.upper)
            assert differences(name, lambda text: text + "\n#define float double\n")
    assert differences("sources/fmu.c", replaced("&m->in.angle", "&m->in.torque"))


def test_what_is_more_or_less(differences, entries, sampled_export):
    assert differences(**{"sources/other.c": b""}) == ["sources/other.c is not in an export"]
    for name in entries:
        left = packed({k: v for k, v in entries.items() if k != name})
        assert [*model_differences(left, sampled_export)] == [f"{name} is missing"]


def test_hostile_files(differences, entries, sampled_export):
    bomb = '<!DOCTYPE a [<!ENTITY a "b">]>'
    assert differences(XML, replaced("<fmi", f"{bomb}<fmi"))
    assert differences(XML, lambda text: "no XML")
    assert differences(XML, lambda text: text[:-30])
    pressed = io.BytesIO()
    with zipfile.ZipFile(pressed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("x", bytes(2**24))
    many = packed({str(k): b"" for k in range(1000)})
    whole = packed(entries)
    around = (b"before" + whole, whole + b"behind", packed({"x": b""}) + whole)
    for content in (b"", b"PK", pressed.getvalue(), many, whole[:-9], *around):
        (found,) = model_differences(content, sampled_export)
        assert found == "it is no archive that was exported"
