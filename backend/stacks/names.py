"""Names of uploaded files. They are data: shown and sorted, never turned into a path."""

from pathlib import PurePosixPath

from backend.platform.texts import is_storable
from backend.stacks.errors import BadName

MAX_NAME_CHARACTERS = 1000


def checked(name: str) -> str:
    """Return `name` if it is a relative name as browsers give it (`folder/frame 1.tif`), refuse it otherwise."""
    if not name or len(name) > MAX_NAME_CHARACTERS:
        raise BadName(f"give 1 to {MAX_NAME_CHARACTERS} characters")
    if not is_storable(name) or any(ord(character) < 32 for character in name):
        raise BadName("holds a control character")
    parts = PurePosixPath(name).parts
    if name.startswith("/") or "\\" in name or ".." in parts or name.endswith("/") or not parts:
        raise BadName("give a relative name such as folder/frame1.tif")
    return name
