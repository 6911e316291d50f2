"""What can be wrong about webhooks."""

from http import HTTPStatus

from backend.platform.problems import Conflict, NotFound, ServiceError
from dropflow.errors import FieldProblem


class NoSuchWebhook(NotFound):
    """It does not exist, or belongs to another group."""

    def __init__(self) -> None:
        super().__init__("The group has no such webhook.", code="not_found.webhook")


class NoSuchNotice(NotFound):
    """It does not exist, or was sent to another webhook."""

    def __init__(self) -> None:
        super().__init__("This webhook was never sent that.", code="not_found.notice")


class BadAddress(ServiceError):
    """Nothing is ever sent there."""

    default_code = "webhook.address"
    status = HTTPStatus.UNPROCESSABLE_ENTITY

    def __init__(self, message: str) -> None:
        super().__init__(
            "Nothing can be sent there.",
            fields=[FieldProblem("address", message)],
            hint="An administrator may allow networks inside the house (OUTWARD_NETWORKS).",
        )


class TooManyWebhooks(Conflict):
    """More than a group needs."""

    def __init__(self, n_webhooks: int) -> None:
        super().__init__(
            f"The group has {n_webhooks} webhooks already.", code="conflict.webhooks", hint="Remove one of them."
        )


class WebhookPaused(Conflict):
    """Nothing is sent while it is paused."""

    def __init__(self) -> None:
        super().__init__("This webhook is paused.", code="conflict.webhook_paused", hint="Switch it on first.")
