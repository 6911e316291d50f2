"""Imports as the API shows and takes them."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from backend.models import ImportMode
from backend.platform.texts import Words


class OutsideFile(BaseModel):
    """A file that could be imported."""

    name: str
    size_bytes: int


class Place(BaseModel):
    """What is in a folder below a root, or which roots there are."""

    roots: list[str]
    """All that frames of this experiment may be imported from."""
    root: str | None
    path: str
    folders: list[str]
    files: list[OutsideFile]
    """The first 200."""
    n_files: int
    size_bytes: int


class NewImport(BaseModel):
    """Where the frames are."""

    model_config = ConfigDict(
        extra="forbid", json_schema_extra={"examples": [{"root": "microscope", "path": "2024/run 1", "mode": "copy"}]}
    )

    root: Annotated[Words, Field(max_length=50)]
    """One of `GET .../imports`."""
    path: Annotated[Words, Field(max_length=1000)] = ""
    """Below it: a folder of frames, or one file."""
    mode: ImportMode = ImportMode.COPY
    """`reference` leaves the files where they are: they must stay there, unchanged, as long as they are needed."""
