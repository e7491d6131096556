"""Tissue laws from records of force and deflection."""

from nrs_design.identification.tissue.identify import TissueIdentification, identify_tissue
from nrs_design.identification.tissue.output_error import RecordFit, fit_record
from nrs_design.identification.tissue.pool import ModelFit, fit_model

__all__ = [
    "ModelFit",
    "RecordFit",
    "TissueIdentification",
    "fit_model",
    "fit_record",
    "identify_tissue",
]
