"""Specs: YAML files with exact numbers, units and line numbers, as frozen models.

Every name here is imported from its module when it is first asked for: a command pays only for the
kind of spec that it reads. `Spec`, any of them, is for annotations only.
"""

from typing import TYPE_CHECKING

from nrs_design.late import late_names

if TYPE_CHECKING:
    from nrs_design.spec.affine import Affine
    from nrs_design.spec.controllers import (
        ControllerSpec,
        CostWeights,
        ForceControllerSpec,
        IdleStatesSpec,
        ImpedanceControllerSpec,
        PositionControllerSpec,
    )
    from nrs_design.spec.doubts import Doubt, doubt_spec, worst_first
    from nrs_design.spec.environment import (
        ElasticSpec,
        EnvironmentSpec,
        KelvinVoigtSpec,
    )
    from nrs_design.spec.exact import parse_exact
    from nrs_design.spec.gain_fields import GainSpec
    from nrs_design.spec.goals import GoalsSpec
    from nrs_design.spec.interaction import InteractionDesignSpec
    from nrs_design.spec.interaction_parts import DesignSpec
    from nrs_design.spec.load import LoadedSpec, Spec, load_spec, parse_spec, read_spec
    from nrs_design.spec.motion import (
        ActuatorIntervals,
        ActuatorSpec,
        LimitsSpec,
        MotionLoopSpec,
        TransferFunctionSpec,
    )
    from nrs_design.spec.parameters import ParameterSpec
    from nrs_design.spec.provenance import ProvenanceSpec
    from nrs_design.spec.quantity import Quantity
    from nrs_design.spec.quantity_fields import Bounds, RangedQuantity
    from nrs_design.spec.robot import (
        BalancedLegSpec,
        BalanceSpec,
        BodySpec,
        DriveSpec,
        LegSpec,
        RobotControlSpec,
        RobotSpec,
    )
    from nrs_design.spec.switched_system import ModeSpec, SwitchedSystemSpec
    from nrs_design.spec.switching import DwellTime, ResetSpec, SwitchingSpec

__all__ = [
    "ActuatorIntervals",
    "ActuatorSpec",
    "Affine",
    "BalanceSpec",
    "BalancedLegSpec",
    "BodySpec",
    "Bounds",
    "ControllerSpec",
    "CostWeights",
    "DesignSpec",
    "Doubt",
    "DriveSpec",
    "DwellTime",
    "ElasticSpec",
    "EnvironmentSpec",
    "ForceControllerSpec",
    "GainSpec",
    "GoalsSpec",
    "IdleStatesSpec",
    "ImpedanceControllerSpec",
    "InteractionDesignSpec",
    "KelvinVoigtSpec",
    "LegSpec",
    "LimitsSpec",
    "LoadedSpec",
    "ModeSpec",
    "MotionLoopSpec",
    "ParameterSpec",
    "PositionControllerSpec",
    "ProvenanceSpec",
    "Quantity",
    "RangedQuantity",
    "ResetSpec",
    "RobotControlSpec",
    "RobotSpec",
    "Spec",
    "SwitchedSystemSpec",
    "SwitchingSpec",
    "TransferFunctionSpec",
    "doubt_spec",
    "load_spec",
    "parse_exact",
    "parse_spec",
    "read_spec",
    "worst_first",
]

_HOMES = {
    name: module
    for module, names in {
        "affine": "Affine",
        "controllers": "ControllerSpec CostWeights ForceControllerSpec "
        "IdleStatesSpec ImpedanceControllerSpec "
        "PositionControllerSpec",
        "doubts": "Doubt doubt_spec worst_first",
        "environment": "ElasticSpec EnvironmentSpec KelvinVoigtSpec",
        "exact": "parse_exact",
        "gain_fields": "GainSpec",
        "goals": "GoalsSpec",
        "interaction": "InteractionDesignSpec",
        "interaction_parts": "DesignSpec",
        "load": "LoadedSpec load_spec parse_spec read_spec",
        "motion": "ActuatorIntervals ActuatorSpec LimitsSpec MotionLoopSpec TransferFunctionSpec",
        "parameters": "ParameterSpec",
        "provenance": "ProvenanceSpec",
        "quantity": "Quantity",
        "quantity_fields": "Bounds RangedQuantity",
        "robot": "BalancedLegSpec BalanceSpec BodySpec "
        "DriveSpec LegSpec RobotControlSpec RobotSpec",
        "switched_system": "ModeSpec SwitchedSystemSpec",
        "switching": "DwellTime ResetSpec SwitchingSpec",
    }.items()
    for name in names.split()
}

__getattr__ = late_names(__name__, _HOMES)
