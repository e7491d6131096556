"""Specs: YAML files with exact numbers, units and line numbers, as frozen models.

Every name here is imported from its module when it is first asked for: a command pays only for the
kind of spec that it reads. `Spec`, any of them, is for annotations only.
"""

from typing import TYPE_CHECKING

from nrs_design.late import late_names

if TYPE_CHECKING:
    from nrs_design.spec.controllers import ControllerSpec as ControllerSpec
    from nrs_design.spec.controllers import IdleStatesSpec as IdleStatesSpec
    from nrs_design.spec.controllers import ImpedanceControllerSpec as ImpedanceControllerSpec
    from nrs_design.spec.exact import parse_exact as parse_exact
    from nrs_design.spec.interaction import InteractionDesignSpec as InteractionDesignSpec
    from nrs_design.spec.load import LoadedSpec as LoadedSpec
    from nrs_design.spec.load import Spec as Spec
    from nrs_design.spec.load import load_spec as load_spec
    from nrs_design.spec.load import parse_spec as parse_spec
    from nrs_design.spec.load import read_spec as read_spec
    from nrs_design.spec.plausible import Doubt as Doubt
    from nrs_design.spec.plausible import doubt_spec as doubt_spec
    from nrs_design.spec.quantity import Quantity as Quantity
    from nrs_design.spec.quantity_fields import GainSpec as GainSpec
    from nrs_design.spec.robot import RobotSpec as RobotSpec
    from nrs_design.spec.switched_system import SwitchedSystemSpec as SwitchedSystemSpec
    from nrs_design.spec.switching import SwitchingSpec as SwitchingSpec

__getattr__ = late_names(
    __name__,
    {
        "controllers": "ControllerSpec IdleStatesSpec ImpedanceControllerSpec",
        "exact": "parse_exact",
        "interaction": "InteractionDesignSpec",
        "load": "LoadedSpec load_spec parse_spec read_spec",
        "plausible": "Doubt doubt_spec",
        "quantity": "Quantity",
        "quantity_fields": "GainSpec",
        "robot": "RobotSpec",
        "switched_system": "SwitchedSystemSpec",
        "switching": "SwitchingSpec",
    },
)
