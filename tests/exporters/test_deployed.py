"""Deployed files against a certificate: every token counts, and nothing hides one."""

import json
import re
from dataclasses import replace

import pytest

from nrs_design.errors import NrsDesignError
from nrs_design.exporters.deployed import find_differences
from nrs_design.exporters.export import export_design
from nrs_design.exporters.formats.c import render as render_c
from nrs_design.exporters.formats.json import render as render_json
from nrs_design.exporters.formats.monitor import render as render_monitor
from nrs_design.spec import read_spec
from nrs_design.spec.coupling import CouplingSpec
from nrs_design.spec.monitoring import MonitoringSpec
from tests.support import ROBOT, ROOT, SOFT_TISSUE, ends_soon


@pytest.fixture
def differences(sampled, sampled_export, tmp_path):
    """Write a file and compare it with the certificate of the sampled loop."""

    def compare(text, name="law.h"):
        (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
        return find_differences(tmp_path / name, sampled.spec, sampled_export.certificate)

    return compare


@pytest.fixture(scope="module")
def header(sampled_export):
    return render_c(sampled_export)[".h"].decode()


def test_what_was_exported_has_no_difference(differences, header, sampled_export):
    assert differences(header) == []
    assert differences(header.replace("\n", "\r\n")) == []
    assert differences(render_json(sampled_export)[".export.json"], "x.json") == []


def test_comments_and_space_are_no_difference(differences, header):
    for old, new in (
        ("#define", "  #  define"),
        ("#endif", "// the end\n#endif /* of it */"),
    ):
        assert old in header
        assert differences(header.replace(old, new)) == [], new


def test_every_number_counts_to_the_last_bit(differences, header):
    """Each macro in turn: another number, or none at all."""
    lines = [line for line in header.splitlines() if re.match(r"#define \w+ \S", line)]
    assert len(lines) > 12
    for line in lines:
        _, name, number, *_ = line.split()
        if number.endswith("U"):
            others = [f"{int(number[:-1]) + 1}U", number[:-1]]
        else:
            value = float.fromhex(number[:-1])
            others = [(value * (1 + 2**-23)).hex() + "F", f"-{number}", number[:-1], "0.0F", "x"]
            # As an unsigned integer it would not be the same in an expression.
            others += [f"{int(value)}U"] * value.is_integer()
        for other in others:
            found = differences(header.replace(line, f"#define {name} {other}"))
            assert len(found) == 1, (line, other)
            assert name in found[0]
        assert len(differences(header.replace(line, ""))) == 1


@pytest.mark.parametrize(
    "addition",
    [
        "#undef OWN_KP",
        "#define OWN_KP 0x1p0F",
        "#define float double",
        "#if 0\n#endif",
        "#ifdef X\n#endif",
        '#include "other.h"',
        "#include <math.h>",
        "#pragma STDC FP_CONTRACT ON",
        "#define OWN_NEW 1U",
        "%:define OWN_KP 0x1p0F",
        "??=define OWN_KP 0x1p0F",
        "// comment \\\n#define X",
        'const char *x = "/*";\n#define OWN_KP 0x1p0F\nconst char *y = "*/";',
        "int a;\x0c#define OWN_KP 0x1p0F",
    ],
)
def test_nothing_hides_another_number(differences, header, addition):
    own = re.search(r"#define (\w+)_KP ", header)[1]
    more = addition.replace("OWN", own)
    assert differences(header.replace("#include <stdint.h>", f"#include <stdint.h>\n{more}"))


def test_a_part_that_is_not_compiled_is_noticed(differences, header):
    assert differences(header.replace("#endif\n", ""))
    assert differences(header.replace("#ifndef", "#ifdef", 1))
    assert differences(header + "\n#ifndef X\n#endif\n")
    assert differences("")


def test_every_gain_of_a_record_counts(differences, sampled_export):
    document = json.loads(render_json(sampled_export)[".export.json"])
    changed = json.dumps(document | {"spec": {"name": "x", "sha256": 64 * "0"}})
    assert differences(changed, "x.json") == ["it is of another spec, or of an earlier text of it"]
    other = {"exact": "0.5", "float32": 0.5, "float32_bits": "0x3f000000"}
    for place in (document["motion"], document["controllers"][0]):
        for i, gain in enumerate(place["gains"]):
            place["gains"][i] = gain | other
            (found,) = differences(json.dumps(document), "x.json")
            assert f"{gain['name']} of" in found
            assert gain["exact"] in found
            place["gains"][i] = gain
    twice = document["motion"]["gains"] * 2
    repeated = json.dumps(document | {"motion": {"law": "motion", "gains": twice}})
    assert differences(repeated, "x.json") == ["a controller or a gain is there twice"]
    document["controllers"][0]["name"] = "other"
    assert len(differences(json.dumps(document), "x.json")) == 5


ONE = {"unit": "1/s", "exact": "0.5", "float32": 0.5, "float32_bits": "0x3f000000"}
PROOF = "its field 'proof' is not what the certificate says"


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        ("proof.claim", "everything", PROOF),
        ("proof.decay_rate.exact", "1/9", PROOF),
        ("outside", [], "its field 'outside' is not what the certificate says"),
        ("motion.gains.0.unit", "rpm/deg", "rpm/deg, and the certificate has"),
        ("controllers.0.law", "force", "laws and contacts: insertion: force at soft"),
        ("controllers.0.contacts", ["hard"], "impedance at hard"),
        ("delay", [1, 1], "age of the force sample: 1 to 1"),
        ("force_filter", {"order": 2, "pole": ONE | {"name": "pole"}}, "their pole: 2, 0.5"),
        ("idle_states", {"decay": ONE | {"name": "decay"}, "reset": True}, "0.5 1/s, True"),
        ("offset", "measured", "offset: measured"),
        ("sample_time", {"exact": "0.004", "unit": "s"}, "sample time in s: 0.004"),
        ("sample_time", None, "sample time in s: none, and the certificate has 0.002"),
    ],
)
def test_what_else_a_record_says_counts(differences, sampled_export, place, value, said):
    """Its proof, units, laws and contacts, and what runs beside the gains."""
    document = json.loads(render_json(sampled_export)[".export.json"])
    *path, last = place.split(".")
    node = document
    for key in path:
        node = node[int(key) if key.isdigit() else key]
    node[last] = value
    (found,) = differences(json.dumps(document), "x.json")
    assert said in found


def test_records_of_every_kind_agree_with_their_certificates(tmp_path):
    """With a filter, idle states and an offset, too."""
    head, _, _ = SOFT_TISSUE.read_text().partition("  withdrawal:")
    text = head + "switching: arbitrary\nsensor: {filter: {order: 1, cutoff: 100 Hz}}\n"
    (tmp_path / "filtered.nrs.yaml").write_text(text)
    for file in (
        tmp_path / "filtered.nrs.yaml",
        ROOT / "docs/examples/mixed-controllers.nrs.yaml",
        ROBOT / "force-limit-offset.nrs.yaml",
    ):
        loaded = read_spec(file)
        export = export_design(loaded)
        (tmp_path / "x.json").write_bytes(render_json(export)[".export.json"])
        assert find_differences(tmp_path / "x.json", loaded.spec, export.certificate) == []


def test_files_that_are_something_else(differences, header):
    for text, name in (
        (header, "law.hpp"),
        ("{}", "x.json"),
        ("[" * 10_000, "x.json"),
        (b"\xff", "x.json"),
        ("é", "x.h"),
        (b" " * (2**22 + 1), "x.h"),
    ):
        with pytest.raises(NrsDesignError) as caught:
            differences(text, name)
        assert caught.value.remedy
        assert caught.value.path.name == name


def test_what_is_not_there(sampled, sampled_export, tmp_path):
    for name in ("none.h", "folder.h"):
        (tmp_path / "folder.h").mkdir(exist_ok=True)
        with pytest.raises(NrsDesignError, match="cannot be read"):
            find_differences(tmp_path / name, sampled.spec, sampled_export.certificate)


def test_hostile_headers_are_read_in_time(differences):
    for text in ("/*" * 2**18, "/" * 2**19, '"' * 2**19, "#define A 1\n" * 20_000, "#" * 2**19):
        with ends_soon():
            assert differences(text)
    for number in ("0x" + "f" * 10**6 + "p0F", "9" * 10**6 + ".0F", "1e999999999F", "0x1p99999F"):
        with ends_soon():
            assert differences(f"#define A {number}")


def test_a_continuous_certificate_says_nothing_of_a_program(
    continuous, continuous_export, header, tmp_path
):
    (tmp_path / "law.h").write_text(header)
    with pytest.raises(NrsDesignError, match="continuous time"):
        find_differences(tmp_path / "law.h", continuous.spec, continuous_export.certificate)


def test_a_monitor_is_that_of_the_certificate(differences, sampled_export):
    """Its limits to the last bit, and its names; what is beside them says nothing."""
    files = {ending: text.decode() for ending, text in render_monitor(sampled_export).items()}
    for ending, text in files.items():
        assert differences(text, f"law{ending}") == []
        assert differences(text.replace("\n", "\r\n"), f"law{ending}") == []
        assert differences(text.replace("*/", "or so */", 1), f"law{ending}") == []
    header, source = files["_monitor.h"], files["_monitor.c"]
    lines = [line for line in header.splitlines() if re.match(r"#define \w+ \S", line)]
    assert len(lines) == 12
    for line in lines:
        _, name, number, *_ = line.split()
        other = f"{int(number[:-1]) + 1}U" if number.endswith("U") else f"-{number}"
        (found,) = differences(header.replace(line, f"#define {name} {other}"), "law_monitor.h")
        assert f"{name}`" in found
    numbers = re.findall(r"0x1\S*F|\b\d+U", source)
    assert len(numbers) > 5
    for number in {*numbers}:
        one = number.replace("0x1", "0x1.000002") if "x" in number else f"9{number}"
        (found,) = differences(source.replace(number, one, 1), "law_monitor.c")
        assert found.endswith(f"the export has `{number}`")
    for old, new in (("LEFT_STAY", "LEFT_ORDER"), ("m->stay", "m->mode"), ("    ", "#if 0\n")):
        assert old in source
        assert len(differences(source.replace(old, new, 1), "law_monitor.c")) == 1
    assert differences(source + "\n#undef NAN\n", "law_monitor.c")
    assert differences(source.replace("//", "/").replace(";", "; // \\\n", 1), "law_monitor.c")


def test_a_monitor_of_coupled_axes_keeps_their_speed(sampled, sampled_export, tmp_path):
    numbers = {"inertia": ["0.003 kg*m^2", "0.3 kg*m^2"], "coriolis": "1 N*m*s/rad"}
    coupling = CouplingSpec.model_validate(numbers | {"speed": "8 deg/s"})
    spec = sampled.spec.model_copy(update={"coupling": coupling})
    files = render_monitor(replace(sampled_export, spec=spec))

    def differences(ending, old="", new=""):
        text = files[ending].decode()
        assert old in text
        (tmp_path / f"law{ending}").write_text(text.replace(old, new))
        return find_differences(tmp_path / f"law{ending}", spec, sampled_export.certificate)

    assert differences("_monitor.h") == differences("_monitor.c") == []
    (line,) = (n for n in files["_monitor.h"].decode().splitlines() if "MONITOR_SPEED" in n)
    (found,) = differences("_monitor.h", line, f"{line.split('_SPEED')[0]}_SPEED 0x1.0p-2F")
    assert "MONITOR_SPEED" in found
    for old, new in (("in->speed", "in->step"), ("_MONITOR_SPEED)", "_MONITOR_TORQUE)")):
        assert len(differences("_monitor.c", old, new)) == 1


def test_a_monitor_that_tests_the_stiffness_keeps_its_numbers(sampled, sampled_export, tmp_path):
    said = {"torque_noise": "2 N*mm", "angle_noise": "0.005 deg", "surface": "free"}
    told = MonitoringSpec.model_validate(said | {"speed": "1 rad/s", "surface_speed": "1e-3 rad/s"})
    spec = sampled.spec.model_copy(update={"monitoring": told, "contact": "losable"})
    files = render_monitor(replace(sampled_export, spec=spec))

    def differences(ending, old="", new=""):
        text = files[ending].decode()
        assert old in text
        (tmp_path / f"law{ending}").write_text(text.replace(old, new, 1))
        return find_differences(tmp_path / f"law{ending}", spec, sampled_export.certificate)

    assert differences("_monitor.h") == differences("_monitor.c") == []
    for line in files["_monitor.h"].decode().splitlines():
        if "0x1." in line and "_MONITOR_" in line:
            assert len(differences("_monitor.h", line, line.replace("0x1.", "0x1.8", 1))) == 1
    for old, new in (
        ("m->low > m->high", "m->low < m->high"),
        ("_YIELD_MOST", "_YIELD_LEAST"),
        ("angle - (deep", "angle + (deep"),
        ("larger(m->low", "smaller(m->low"),
    ):
        assert len(differences("_monitor.c", old, new)) == 1


def _leaves(node, at=()):
    pairs = node.items() if isinstance(node, dict) else enumerate(node)
    for key, held in pairs:
        yield (*at, key)
        if isinstance(held, dict | list):
            yield from _leaves(held, (*at, key))


def test_every_field_of_a_record_counts_but_its_release(differences, sampled_export):
    text = render_json(sampled_export)[".export.json"].decode()
    for way in [*_leaves(json.loads(text))]:
        document = json.loads(text)
        node = document
        for key in way[:-1]:
            node = node[key]
        held = node.pop(way[-1])
        for changed in ((), (f"{held}x",)) if isinstance(node, dict) else ((f"{held}x",),):
            if changed and isinstance(node, dict):
                node[way[-1]] = changed[0]
            elif changed:
                node.insert(way[-1], changed[0])
            try:
                found = differences(json.dumps(document), "x.json")
            except NrsDesignError:
                continue
            assert bool(found) is (way[0] != "package"), (way, changed)
