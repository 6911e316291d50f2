"""How a try to send a notice ended."""

from typing import TypedDict


class Outcome(TypedDict):
    """`status` is the receiver's answer, if there was one; what is final is not tried again."""

    status: int | None
    problem: str | None
    is_delivered: bool
    is_final: bool
