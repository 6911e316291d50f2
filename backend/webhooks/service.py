"""What can be done with webhooks. Whoever manages a group decides what of it is told to whom."""

from uuid import UUID

from sqlalchemy.orm import Session

from backend.groups import service as groups
from backend.models import Event, Notice, NoticeState, Webhook
from backend.platform.audit import tell
from backend.platform.outward import NotAllowed, check_address
from backend.platform.settings import Settings
from backend.platform.signatures import new_salt, secret_of
from backend.platform.visibility import Viewer
from backend.webhooks import repository, schemas
from backend.webhooks.errors import BadAddress, NoSuchNotice, NoSuchWebhook, TooManyWebhooks, WebhookPaused

MOST = 20


def webhooks(session: Session, viewer: Viewer, group_id: UUID) -> list[schemas.Webhook]:
    """The webhooks of a group."""
    groups.get(session, viewer, group_id)
    return [_shown(webhook) for webhook in repository.webhooks(session, group_id)]


def create(
    session: Session, settings: Settings, viewer: Viewer, group_id: UUID, new: schemas.NewWebhook
) -> schemas.MadeWebhook:
    """Make a webhook; its secret is shown now and never again."""
    groups.get(session, viewer, group_id)
    _check(settings, new.address)
    if repository.n_webhooks(session, group_id) >= MOST:
        raise TooManyWebhooks(MOST)
    webhook = Webhook(group_id=group_id, address=new.address, events=list(new.events), salt=new_salt())
    session.add(webhook)
    session.flush()
    session.refresh(webhook)
    tell(session, webhook_id=webhook.id, address=webhook.address)
    return _with_secret(settings, webhook)


def change(
    session: Session,
    settings: Settings,
    viewer: Viewer,
    group_id: UUID,
    webhook_id: UUID,
    change: schemas.ChangeWebhook,
) -> schemas.Webhook:
    """Change where to, what, or whether at all."""
    webhook = _found(session, viewer, group_id, webhook_id)
    if change.address is not None:
        _check(settings, change.address)
    for name, value in change.model_dump(exclude_none=True).items():
        setattr(webhook, name, value)
    session.flush()
    tell(session, address=webhook.address, is_active=webhook.is_active)
    return _shown(webhook)


def renew_secret(
    session: Session, settings: Settings, viewer: Viewer, group_id: UUID, webhook_id: UUID
) -> schemas.MadeWebhook:
    """Sign with another secret from now on."""
    webhook = _found(session, viewer, group_id, webhook_id)
    webhook.salt = new_salt()
    session.flush()
    tell(session, address=webhook.address)
    return _with_secret(settings, webhook)


def delete(session: Session, viewer: Viewer, group_id: UUID, webhook_id: UUID) -> None:
    """Tell it nothing more, also not what waits."""
    webhook = _found(session, viewer, group_id, webhook_id)
    tell(session, address=webhook.address)
    session.delete(webhook)


def notices(
    session: Session, viewer: Viewer, group_id: UUID, webhook_id: UUID, query: schemas.NoticeQuery
) -> schemas.Notices:
    """What a webhook was told."""
    webhook = _found(session, viewer, group_id, webhook_id)
    found, next_cursor = repository.notices(session, webhook.id, query)
    return schemas.Notices(items=[_shown_notice(notice) for notice in found], next_cursor=next_cursor)


def try_out(session: Session, viewer: Viewer, group_id: UUID, webhook_id: UUID) -> schemas.Notice:
    """Tell it something that did not happen."""
    webhook = _found(session, viewer, group_id, webhook_id)
    group = groups.get(session, viewer, group_id)
    about = {"group": {"id": str(group.id), "name": group.name}}
    return _put(session, webhook, Notice(webhook_id=webhook.id, event=Event.TEST, about=about))


def resend(session: Session, viewer: Viewer, group_id: UUID, webhook_id: UUID, notice_id: UUID) -> schemas.Notice:
    """Tell the same again, as a notice of its own: the receiver forgets what it was told twice under one id."""
    webhook = _found(session, viewer, group_id, webhook_id)
    told = repository.notice(session, webhook.id, notice_id)
    if told is None:
        raise NoSuchNotice
    again = Notice(webhook_id=webhook.id, run_id=told.run_id, event=told.event, about=told.about, resend_of=told.id)
    return _put(session, webhook, again)


def _put(session: Session, webhook: Webhook, notice: Notice) -> schemas.Notice:
    if not webhook.is_active:
        raise WebhookPaused
    session.add(notice)
    session.flush()
    session.refresh(notice)
    tell(session, address=webhook.address, notice_id=notice.id)
    return _shown_notice(notice)


def _found(session: Session, viewer: Viewer, group_id: UUID, webhook_id: UUID) -> Webhook:
    groups.get(session, viewer, group_id)
    webhook = repository.find(session, group_id, webhook_id)
    if webhook is None:
        raise NoSuchWebhook
    return webhook


def _check(settings: Settings, address: str) -> None:
    try:
        check_address(address, settings.outward_networks)
    except NotAllowed as problem:
        raise BadAddress(str(problem)) from None


def _shown(webhook: Webhook) -> schemas.Webhook:
    return schemas.Webhook.model_validate(webhook)


def _with_secret(settings: Settings, webhook: Webhook) -> schemas.MadeWebhook:
    return schemas.MadeWebhook(**_shown(webhook).model_dump(), secret=secret_of(settings, webhook.salt))


def _shown_notice(notice: Notice) -> schemas.Notice:
    return schemas.Notice(
        id=notice.id,
        event=notice.event,
        about=notice.about,
        resend_of=notice.resend_of,
        created_at=notice.created_at,
        state=notice.state,
        tries=[schemas.Try.model_validate(found) for found in notice.tries],
        next_try_at=notice.due_at if notice.state is NoticeState.WAITING else None,
    )
