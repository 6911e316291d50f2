"""/groups/{group_id}/webhooks."""

from http import HTTPStatus
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Query

from backend.groups.errors import NoSuchGroup
from backend.platform.dependencies import ManagerDependency, PlatformDependency, SessionDependency
from backend.platform.problems import InvalidRequest, responses
from backend.platform.rates import TooOften
from backend.webhooks import schemas, service
from backend.webhooks.errors import BadAddress, NoSuchNotice, NoSuchWebhook, TooManyWebhooks, WebhookPaused

router = APIRouter(prefix="/groups/{group_id}/webhooks", tags=["webhooks"])
SENT_BY_HAND_PER_MINUTE = 20


@router.get("", responses=responses(NoSuchGroup, InvalidRequest))
def webhooks_list(session: SessionDependency, viewer: ManagerDependency, group_id: UUID) -> schemas.Webhooks:
    """List the addresses that are told what happens in a group."""
    return schemas.Webhooks(items=service.webhooks(session, viewer, group_id))


@router.post(
    "",
    status_code=HTTPStatus.CREATED,
    responses=responses(NoSuchGroup, TooManyWebhooks, BadAddress, InvalidRequest),
)
def webhooks_create(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: ManagerDependency,
    group_id: UUID,
    new: schemas.NewWebhook,
) -> schemas.MadeWebhook:
    """Have an address told when runs of a group end. The secret that signs what is sent is shown this once."""
    return service.create(session, platform.settings, viewer, group_id, new)


@router.patch("/{webhook_id}", responses=responses(NoSuchGroup, NoSuchWebhook, BadAddress, InvalidRequest))
def webhooks_update(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: ManagerDependency,
    group_id: UUID,
    webhook_id: UUID,
    change: schemas.ChangeWebhook,
) -> schemas.Webhook:
    """Change a webhook, or pause it: of what happens meanwhile it is told nothing."""
    return service.change(session, platform.settings, viewer, group_id, webhook_id, change)


@router.delete(
    "/{webhook_id}",
    status_code=HTTPStatus.NO_CONTENT,
    responses=responses(NoSuchGroup, NoSuchWebhook, InvalidRequest),
)
def webhooks_delete(session: SessionDependency, viewer: ManagerDependency, group_id: UUID, webhook_id: UUID) -> None:
    """Remove a webhook with its log."""
    service.delete(session, viewer, group_id, webhook_id)


@router.post("/{webhook_id}/secret", responses=responses(NoSuchGroup, NoSuchWebhook, InvalidRequest))
def webhooks_renew_secret(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: ManagerDependency,
    group_id: UUID,
    webhook_id: UUID,
) -> schemas.MadeWebhook:
    """Sign with another secret from now on. It is shown this once."""
    return service.renew_secret(session, platform.settings, viewer, group_id, webhook_id)


@router.post(
    "/{webhook_id}/test",
    status_code=HTTPStatus.ACCEPTED,
    responses=responses(NoSuchGroup, NoSuchWebhook, WebhookPaused, TooOften, InvalidRequest),
)
def webhooks_test(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: ManagerDependency,
    group_id: UUID,
    webhook_id: UUID,
) -> schemas.Notice:
    """Send a notice of the event `test`. How that went stands in the log a moment later."""
    platform.rates.count("notices sent by hand", str(group_id), SENT_BY_HAND_PER_MINUTE)
    return service.try_out(session, viewer, group_id, webhook_id)


@router.get("/{webhook_id}/notices", responses=responses(NoSuchGroup, NoSuchWebhook, InvalidRequest))
def notices_list(
    session: SessionDependency,
    viewer: ManagerDependency,
    group_id: UUID,
    webhook_id: UUID,
    query: Annotated[schemas.NoticeQuery, Query()],
) -> schemas.Notices:
    """Read what a webhook was told in the last 30 days, newest first, with every try to send it."""
    return service.notices(session, viewer, group_id, webhook_id, query)


@router.post(
    "/{webhook_id}/notices/{notice_id}/resend",
    status_code=HTTPStatus.ACCEPTED,
    responses=responses(NoSuchGroup, NoSuchWebhook, NoSuchNotice, WebhookPaused, TooOften, InvalidRequest),
)
def notices_resend(
    session: SessionDependency,
    platform: PlatformDependency,
    viewer: ManagerDependency,
    group_id: UUID,
    webhook_id: UUID,
    notice_id: UUID,
) -> schemas.Notice:
    """Send the same again, under a new id."""
    platform.rates.count("notices sent by hand", str(group_id), SENT_BY_HAND_PER_MINUTE)
    return service.resend(session, viewer, group_id, webhook_id, notice_id)
