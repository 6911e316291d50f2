"""Whether there is room for what somebody wants to send, asked before the first byte comes."""

from collections.abc import Mapping, Sequence

from sqlalchemy.orm import Session

from backend.groups.quotas import demand_room
from backend.models import Experiment
from backend.platform.dependencies import Platform
from backend.platform.store_errors import StoreFull
from backend.stacks import names
from backend.stacks import repository as stacks
from backend.stacks.errors import EmptyFile, TooLarge
from backend.stacks.schemas import Role
from backend.stacks.upload import MAX_TABLE_BYTES
from backend.uploads import repository
from backend.uploads.planning import Key
from backend.uploads.schemas import Announced


def check_files(platform: Platform, files: Sequence[Announced]) -> None:
    """Each file has a name that can be used and a size that can be taken."""
    for file in files:
        names.checked(file.name)
        if file.size_bytes == 0:
            raise EmptyFile(file.name)
        is_table = file.role not in (Role.FRAMES, Role.FLAT_FIELD)
        limit = ("table", MAX_TABLE_BYTES) if is_table else ("file", platform.settings.max_file_bytes)
        if file.size_bytes > limit[1]:
            raise TooLarge(*limit, file.name)


def check_room(
    session: Session,
    platform: Platform,
    experiment: Experiment,
    new: Sequence[Announced],
    replaced: Mapping[Key, tuple[int, str]],
) -> None:
    """The stack stays within its limit, the group within its own, and the disk can hold it."""
    new_bytes = sum(file.size_bytes for file in new)
    old_bytes = sum(replaced[file.key][0] for file in new if file.key in replaced)
    kept_bytes = stacks.size_bytes(session, experiment.id) + repository.bytes_to_come(session, experiment.id)
    if new and kept_bytes - old_bytes + new_bytes > platform.settings.max_stack_bytes:
        raise TooLarge("stack", platform.settings.max_stack_bytes, new[0].name)
    if new:
        demand_room(session, platform.settings, experiment.group, new_bytes - old_bytes)
    free_bytes = platform.store.free_bytes()
    needed_bytes = repository.bytes_to_come(session) + new_bytes
    if new and free_bytes is not None and needed_bytes > free_bytes:
        raise StoreFull(f"The storage has {free_bytes:,} bytes left, and {needed_bytes:,} bytes are still to come.")
