"""The tables. Postgres is the truth about runs; everything else may be emptied at any moment."""

from backend.models.access import (
    ApiToken,
    AuditEntry,
    BrowserSession,
    Invitation,
    Scope,
    ShareLink,
    SignInLink,
)
from backend.models.base import Base
from backend.models.experiments import Experiment, File, Import, ImportMode, Stack
from backend.models.notices import Event, Notice, NoticeState, Webhook
from backend.models.people import Group, Membership, Person, Right
from backend.models.presets import Preset
from backend.models.requests import IdempotencyKey
from backend.models.runs import DoomedObject, FrameSummary, Product, Run, Shard, Speed, Stage, Tally
from backend.models.uploads import Upload, UploadPiece

__all__ = [
    "ApiToken",
    "AuditEntry",
    "Base",
    "BrowserSession",
    "DoomedObject",
    "Event",
    "Experiment",
    "File",
    "FrameSummary",
    "Group",
    "IdempotencyKey",
    "Import",
    "ImportMode",
    "Invitation",
    "Membership",
    "Notice",
    "NoticeState",
    "Person",
    "Preset",
    "Product",
    "Right",
    "Run",
    "Scope",
    "Shard",
    "ShareLink",
    "SignInLink",
    "Speed",
    "Stack",
    "Stage",
    "Tally",
    "Upload",
    "UploadPiece",
    "Webhook",
]
