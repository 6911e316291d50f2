"""What can be done with links to runs. Whoever may edit a run may show it."""

from datetime import UTC, datetime, timedelta
from uuid import UUID

from sqlalchemy.orm import Session

from backend.models import ShareLink
from backend.platform.audit import tell
from backend.platform.secrets import hashed, new_secret
from backend.platform.settings import Settings
from backend.platform.visibility import Viewer
from backend.runs.service import get as get_run
from backend.shares import repository, schemas
from backend.shares.errors import NoSuchShare


def shares(session: Session, viewer: Viewer, run_id: UUID) -> list[schemas.Share]:
    """The links of a run."""
    get_run(session, viewer, run_id)
    return [schemas.Share.model_validate(share) for share in repository.shares(session, run_id)]


def create(
    session: Session, settings: Settings, viewer: Viewer, run_id: UUID, new: schemas.NewShare
) -> schemas.MadeShare:
    """Make a link to a run."""
    get_run(session, viewer, run_id)
    secret = new_secret("run_")
    expires_at = datetime.now(UTC) + timedelta(days=new.days)
    share = ShareLink(run_id=run_id, shared_by=viewer.person_id, secret_hash=hashed(secret), expires_at=expires_at)
    session.add(share)
    session.flush()
    session.refresh(share)
    tell(session, share_id=share.id, days=new.days)
    about = schemas.Share.model_validate(share).model_dump()
    return schemas.MadeShare(**about, link=f"{settings.address}shared#{secret}")


def delete(session: Session, viewer: Viewer, run_id: UUID, share_id: UUID) -> None:
    """Take a link back."""
    get_run(session, viewer, run_id)
    share = repository.find(session, run_id, share_id)
    if share is None:
        raise NoSuchShare
    session.delete(share)
