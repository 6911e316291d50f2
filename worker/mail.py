"""Tells people by e-mail that a run of theirs has ended."""

import smtplib
import ssl
from datetime import datetime
from email.message import EmailMessage
from email.utils import format_datetime, formataddr, parseaddr
from uuid import UUID

from backend.models.base import Json
from backend.platform.outward import LONGEST_S
from backend.platform.reasons import reason_of
from backend.platform.settings import Settings
from worker.sending import Outcome

_FOR_GOOD = 500
"""From here on, an answer of a mail server says that it is no use to try again."""


def send(
    settings: Settings, notice_id: UUID, name: str, mailbox: str, *, event: str, about: Json, at: datetime
) -> Outcome:
    """Try once."""
    del event  # the state of the run says as much
    message = message_of(settings, notice_id, name, mailbox, about, at)
    try:
        with _server(settings) as server:
            server.send_message(message)
    except smtplib.SMTPRecipientsRefused as problem:
        status, words = next(iter(problem.recipients.values()))
        return _refused(status, words)
    except smtplib.SMTPResponseException as problem:
        return _refused(problem.smtp_code, problem.smtp_error)
    except (smtplib.SMTPException, OSError) as problem:
        reason = reason_of(problem)
        return Outcome(status=None, problem=reason, is_delivered=False, is_final=False)
    return Outcome(status=250, problem=None, is_delivered=True, is_final=False)


def message_of(settings: Settings, notice_id: UUID, name: str, mailbox: str, about: Json, at: datetime) -> EmailMessage:
    """The e-mail about a run."""
    run, film = about["run"], " ".join(about["experiment"]["name"].split())  # a header is one line
    message = EmailMessage()
    message["Subject"] = f"Run {run['number']} of {film}: {run['state']}"
    message["From"] = settings.mail_from
    message["To"] = formataddr((name, mailbox))
    message["Date"] = format_datetime(at)
    message["Message-ID"] = f"<{notice_id}@{parseaddr(settings.mail_from or '')[1].rpartition('@')[2]}>"
    message["Auto-Submitted"] = "auto-generated"
    lines = [f"Run {run['number']} of “{film}” ({about['group']['name']}) has {run['state']}.", ""]
    if run["problem"]:
        lines += [run["problem"]["detail"], run["problem"]["hint"] or "", ""]
    lines += [f"{settings.address}runs/{run['id']}", "", "--", "You started it. To get no such e-mail:"]
    message.set_content("\n".join([*lines, f"{settings.address}account"]) + "\n")
    return message


def _server(settings: Settings) -> smtplib.SMTP:
    host, port = settings.smtp_host or "", settings.smtp_port
    context = ssl.create_default_context()
    if settings.smtp_security == "tls":
        server: smtplib.SMTP = smtplib.SMTP_SSL(host, port, timeout=LONGEST_S, context=context)
    else:
        server = smtplib.SMTP(host, port, timeout=LONGEST_S)
    try:
        if settings.smtp_security == "starttls":
            server.starttls(context=context)
        if settings.smtp_user is not None and settings.smtp_password is not None:
            server.login(settings.smtp_user, settings.smtp_password.get_secret_value())
    except BaseException:
        server.close()
        raise
    return server


def _refused(status: int, words: bytes | str) -> Outcome:
    text = words.decode(errors="replace") if isinstance(words, bytes) else words
    return Outcome(status=status, problem=text[:300], is_delivered=False, is_final=status >= _FOR_GOOD)
