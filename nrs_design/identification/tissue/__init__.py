"""Tissue laws from records of force and deflection."""

from nrs_design.identification.tissue.identify import TissueIdentification, identify_tissue
from nrs_design.identification.tissue.offsets import OFFSET_UNITS, OFFSET_WORDS
from nrs_design.identification.tissue.output_error import RecordFit, fit_record
from nrs_design.identification.tissue.pool import ModelFit, fit_model
from nrs_design.identification.tissue.trial import Preparation, Trial, prepare

__all__ = [
    "OFFSET_UNITS",
    "OFFSET_WORDS",
    "ModelFit",
    "Preparation",
    "RecordFit",
    "TissueIdentification",
    "Trial",
    "fit_model",
    "fit_record",
    "identify_tissue",
    "prepare",
]
