"""Interactions to be simulated, small and quick to design."""

from nrs_design.design.analysis import design_controllers
from nrs_design.simulation.build_scenario import build_scenario, default_scenario
from nrs_design.simulation.exact import simulate_exactly
from nrs_design.simulation.sampled import simulate_sampled
from nrs_design.spec import parse_spec
from nrs_design.spec.build_plant import build_plant
from nrs_design.spec.sampling import SamplingSpec
from tests.tables import spec_text

# Motor, motion loop and limits of thesis 4.1, 4.3 and 6.3.1; gains of 6.3.2.1.
ROBOT = spec_text("small-robot")
SOFT = "{model: elastic, stiffness: 43 N*m/rad}"
INSERTION = "{type: impedance, environment: soft, Mt: 0.01 kg*m^2, Bt: 2.15 N*m*s/rad}"
WITHDRAWAL = "{type: impedance, environment: soft, Mt: 0.01 kg*m^2, Bt: 1.04 N*m*s/rad}"
POSITION = "{type: position}"
FORCE = "{type: force, environment: soft, proportional_gain: 0.02 rad/(N*m)}"
IMPEDANCE = {"insertion": INSERTION, "withdrawal": WITHDRAWAL}
PLACED = {"position": POSITION, "force": FORCE}
SAMPLED = "sampling: {period: 2 ms, delay: 1}\n"


def text_of(controllers=None, environments=None, scenario=None, more=""):
    """Return a spec with one scenario, ``run``, or none."""
    lines = [ROBOT, "environments:"]
    lines += [f"  {name}: {text}" for name, text in (environments or {"soft": SOFT}).items()]
    lines += ["controllers:"]
    lines += [f"  {name}: {text}" for name, text in (controllers or IMPEDANCE).items()]
    if scenario is not None:
        lines += [f"scenarios: {{run: {{{scenario}}}}}"]
    return "\n".join([*lines, more])


def simulated(text, engine="exact", sampling=None, **options):
    """Simulate the only scenario of a spec, or its default."""
    spec = parse_spec(text)
    if sampling is not None:
        given = dict(zip(("period", "delay"), map(str, sampling), strict=True))
        spec = spec.model_copy(update={"sampling": SamplingSpec.model_validate(given)})
    plant = build_plant(spec)
    design = design_controllers(spec, plant)
    scenario = (
        build_scenario(spec, plant, "run", spec.scenarios["run"])
        if spec.scenarios
        else default_scenario(spec, plant)
    )
    if engine == "exact":
        return simulate_exactly(spec, plant, design, scenario, **options)
    return simulate_sampled(spec, plant, design, scenario, **options)
