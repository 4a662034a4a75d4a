"""The case file: types that are its schema and its validation, and the problem it describes."""

from anisocontact.case.model import Case
from anisocontact.case.read import CaseError, CaseFile, json_schema, load, validate

__all__ = ["Case", "CaseError", "CaseFile", "json_schema", "load", "validate"]
