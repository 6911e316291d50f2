"""What can be wrong about groups, their members and invitations."""

from http import HTTPStatus

from backend.platform.problems import Conflict, NotFound, ServiceError


class NoSuchGroup(NotFound):
    """The group does not exist, or this person is not in it."""

    def __init__(self) -> None:
        super().__init__("There is no such group.", code="not_found.group")


class NoSuchMember(NotFound):
    """Nobody of this id is in the group."""

    def __init__(self) -> None:
        super().__init__("There is no such member of this group.", code="not_found.member")


class NoSuchInvitation(NotFound):
    """It does not exist, was used, or expired: all answer the same."""

    def __init__(self) -> None:
        super().__init__(
            "This invitation is not valid (any more).",
            code="not_found.invitation",
            hint="Ask whoever invited you for another.",
        )


class LastManager(Conflict):
    """Nobody would be left to manage the group."""

    def __init__(self) -> None:
        super().__init__(
            "Nobody else manages this group.", code="conflict.last_manager", hint="Let somebody else manage it first."
        )


class PersonalGroup(Conflict):
    """The space of one person."""

    def __init__(self) -> None:
        super().__init__(
            "This is one person's own space: nobody joins or leaves it.",
            code="conflict.personal_group",
            hint="Make a group to share.",
        )


class GroupNotEmpty(Conflict):
    """Something still belongs to it."""

    def __init__(self) -> None:
        super().__init__("Experiments still belong to this group.", code="conflict.group_not_empty")


class QuotaExceeded(ServiceError):
    """The group has no room for this."""

    status = HTTPStatus.REQUEST_ENTITY_TOO_LARGE

    def __init__(self, used_bytes: int, max_bytes: int) -> None:
        super().__init__(
            f"The group has used {used_bytes:,} of its {max_bytes:,} bytes; this would not fit.",
            code="quota.bytes",
            hint="Delete what is not needed, or ask an administrator for more room.",
        )


class TooManyRuns(Conflict):
    """The group runs as much at once as it may."""

    def __init__(self, max_active_runs: int) -> None:
        super().__init__(
            f"{max_active_runs} runs of this group are queued or running, which is as many as it may have at once.",
            code="quota.runs",
            hint="Wait until one ends, or cancel one.",
        )
