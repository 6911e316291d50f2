"""E-mail: whoever started a run hears of its end, if they may see it and want to."""

from dataclasses import replace
from uuid import UUID

from sqlalchemy import func, select

from backend.models import Notice, NoticeState, Person, Right
from backend.platform.settings import Settings
from tests.lab import ADDRESS, Lab
from tests.notices import ended, make_due, told
from tests.receiver import MailServer
from worker.context import Context


def mailing(lab: Lab, mailbox: MailServer) -> Context:
    about = {"smtp_host": "127.0.0.1", "smtp_port": mailbox.port, "smtp_security": "none"}
    settings = Settings.model_validate(
        lab.settings.model_dump() | about | {"mail_from": "Dropflow <lab@dropflow.test>"}
    )
    return replace(lab.house.context, settings=settings)


def test_who_started_a_run_gets_an_e_mail_when_it_ends(
    open_door: Lab, group: UUID, ada: UUID, mailbox: MailServer
) -> None:
    run = ended(open_door, group, "complete", ada)
    ended(open_door, group, "cancel", ada)
    context = mailing(open_door, mailbox)
    assert (told(context), told(context)) == (1, 0)
    [message] = mailbox.came
    assert message["Subject"] == "Run 1 of five discs: completed"
    assert message["To"] == f"Ada <{open_door.email(ada)}>"
    assert f"{ADDRESS}runs/{run}" in message.get_content()
    ended(open_door, group, "fail", ada)
    told(context)
    assert "Frame 3 cannot be read." in mailbox.came[1].get_content()


def test_no_e_mail_for_who_does_not_want_it_may_not_see_it_or_is_let_in_no_more(
    open_door: Lab, group: UUID, ada: UUID, mailbox: MailServer
) -> None:
    open_door.browser(ada).patch("account", json={"is_mailed": False}).raise_for_status()
    left, gone = open_door.person("Left"), open_door.person("Gone", {group: Right.EDIT})
    with open_door.house.context.sessions.begin() as session:
        session.get_one(Person, gone).disabled_at = func.now()
    for person in (ada, left, gone):
        ended(open_door, group, "complete", person)
    assert told(mailing(open_door, mailbox)) == 0


def test_a_mail_server_that_is_busy_is_asked_again_and_one_that_knows_nobody_is_not(
    open_door: Lab, group: UUID, ada: UUID, mailbox: MailServer
) -> None:
    context = mailing(open_door, mailbox)
    mailbox.answer = "451 Come back later"
    ended(open_door, group, "complete", ada)
    told(context)
    mailbox.answer = "250 OK"
    make_due(open_door)
    told(context)
    assert len(mailbox.came) == 1
    mailbox.answer = "550 No such user"
    ended(open_door, group, "complete", ada)
    told(context)
    with context.sessions() as session:
        states = session.scalars(select(Notice.state).order_by(Notice.created_at)).all()
    assert states == [NoticeState.DELIVERED, NoticeState.FAILED]


def test_without_a_mail_server_nothing_is_kept_for_one(
    open_door: Lab, group: UUID, ada: UUID, mailbox: MailServer
) -> None:
    ended(open_door, group, "complete", ada)
    told(open_door.house.context)
    assert told(mailing(open_door, mailbox)) == 0


def test_header_injection_the_name_of_a_film_adds_no_line_to_an_e_mail(
    open_door: Lab, group: UUID, ada: UUID, mailbox: MailServer
) -> None:
    run_id = ended(open_door, group, "complete", ada)
    with open_door.house.context.sessions.begin() as session:
        notice = session.scalars(select(Notice).where(Notice.run_id == run_id)).one()
        film = {"id": "1", "name": "a\r\nBcc: everybody@evil.example\r\n\r\nhello"}
        notice.about = notice.about | {"experiment": film}
    told(mailing(open_door, mailbox))
    [message] = mailbox.came
    assert message["Bcc"] is None
    assert message["Subject"] == "Run 1 of a Bcc: everybody@evil.example hello: completed"
