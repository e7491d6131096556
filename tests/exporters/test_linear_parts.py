"""Parts of an axis and their closed loops, beside the modes of the proof and in GNU Octave."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.exporters.export import export_design
from nrs_design.exporters.linear_parts import loop_parts, plant_parts
from nrs_design.exporters.matlab import render
from nrs_design.pipeline import run_design
from nrs_design.spec import read_spec
from nrs_design.switched.assemble import assemble
from tests.exporters.conftest import CONTINUOUS
from tests.exporters.test_matlab import loaded_mat, run_octave
from tests.support import ROOT

FILTER = "sensor: {filter: {order: 2, cutoff: 60 Hz}}\n"
# u = M (K (E y + f)) by the parts alone, at some frequencies, beside the closed loop.
FEEDBACK = """\
d = load("soft-tissue.mat");
at = @(p, s) p.C*((s*eye(rows(p.A)) - p.A)\\p.B) + p.D;
M = d.plant(2);
for i = 1:numel(d.loops)
  L = d.loops(i);
  parts = strsplit(L.name, "/");
  K = d.controllers(strcmp({d.controllers.name}, parts{1}));
  E = d.contacts(strcmp({d.contacts.name}, parts{2}));
  worst = 0;
  for s = j*logspace(-1, 3, 9)
    k = at(K, s);
    if numel(d.force_filter), k = k*at(d.force_filter(1), s); end
    y = at(M, s)*k/(1 - at(M, s)*k*at(E, s));
    wanted = [y; at(E, s)*y];
    worst = max(worst, norm(at(L, s) - wanted)/norm(wanted));
  end
  printf("%s %s %s %d %d\\n", L.name, L.outputs{1}, L.output_units{2}, worst < 1e-9, ...
         max(real(eig(L.A))) < 0)
end
"""


def filtered(folder):
    """Return soft tissue with a filter of the force."""
    file = folder / "filtered.nrs.yaml"
    file.write_text(CONTINUOUS.read_text() + FILTER)
    return file


@pytest.mark.parametrize("name", ["soft-tissue", "force-limit", "tissue-and-tool", "filtered"])
def test_poles_are_those_of_the_modes_of_the_proof(name, tmp_path):
    """At nominal values; a mode has states of other laws and contacts beside those of its loop."""
    file = ROOT / f"specs/neuroboscope/{name}.nrs.yaml"
    designed = run_design(read_spec(filtered(tmp_path) if name == "filtered" else file))
    spec = designed.spec
    loops = list(loop_parts(designed.plant, designed.design))
    assert loops
    system = assemble(spec, designed.plant, designed.design, spec.coordinates, Fraction(0))
    for loop in loops:
        near = [mode for mode in system.modes if mode.name.startswith(loop.name)]
        assert near, [mode.name for mode in system.modes]
        rows = np.array([[float(entry) for entry in row] for row in near[0].A.fractions()])
        of_mode = np.linalg.eigvals(rows)
        for pole in np.linalg.eigvals(loop.A):
            assert np.min(np.abs(of_mode - pole)) < 1e-5 * (1 + abs(pole))


def test_a_motor_that_feels_what_is_touched_has_no_such_loops(tmp_path):
    text = CONTINUOUS.read_text()
    file = tmp_path / "loaded.nrs.yaml"
    old = "  time_constant: 0.0351 s\n"
    assert old in text
    file.write_text(text.replace(old, f"{old}  load_inertia: 1.213 kg*m^2\n"))
    export = export_design(read_spec(file))
    read = loaded_mat(render(export)[".mat"], tmp_path)
    assert "acts on the motor" in str(read["info"]["loops_left_out"])
    assert np.size(read["loops"]) == 0
    assert len(read["plant"]) == 2


def test_units_of_the_parts(continuous):
    designed = run_design(continuous)
    actuator, motion = plant_parts(designed.plant, designed.design)
    assert (actuator.input, actuator.outputs) == (("command", "rpm"), (("position", "rad"),))
    assert motion.B.shape == (2, 1)
    loop, *_ = loop_parts(designed.plant, designed.design)
    assert loop.input == ("force", "N*m")
    assert loop.outputs == (("velocity", "rad/s"), ("contact_force", "N*m"))


@pytest.mark.parametrize("name", ["soft-tissue", "force-limit", "filtered"])
def test_octave_closes_the_loops_from_the_parts(name, tmp_path):
    file = ROOT / f"specs/neuroboscope/{name}.nrs.yaml"
    export = export_design(read_spec(filtered(tmp_path) if name == "filtered" else file))
    lines = run_octave(export, tmp_path, FEEDBACK)
    loops = [loop.name for loop in loop_parts(build(export), export.design)]
    assert [line.split()[0] for line in lines] == loops
    motion = "position" if name == "force-limit" else "velocity"
    assert all(line.endswith(f" {motion} N*m 1 1") for line in lines)


def test_octave_sees_another_controller(continuous_export, tmp_path):
    insertion, *others = continuous_export.design.controllers
    other = replace(insertion, law=replace(insertion.law, Bt=Fraction(3)))
    design = replace(continuous_export.design, controllers=(other, *others))
    spoiled = FEEDBACK.replace("k = at(K, s);", "k = at(K, s)*1.001;")
    lines = run_octave(replace(continuous_export, design=design), tmp_path, spoiled)
    assert all(line.endswith(" velocity N*m 0 1") for line in lines)


def build(export):
    from nrs_design.models.plant import build_plant

    return build_plant(export.spec)
