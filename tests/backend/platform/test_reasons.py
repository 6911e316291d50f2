"""Why something failed, in a line."""

import pytest

from backend.platform.reasons import LONGEST, reason_of


@pytest.mark.parametrize(
    ("problem", "reason"),
    [
        (OSError(28, "No space left on device"), "[Errno 28] No space left on device"),
        (ValueError("\nserver closed the connection\nunexpectedly"), "server closed the connection"),
        (TimeoutError(), "TimeoutError"),
        (ValueError(" \n"), "ValueError"),
        (ValueError("x" * 1000), "x" * LONGEST),
    ],
)
def test_a_reason_is_one_line_and_never_empty(problem: Exception, reason: str) -> None:
    assert reason_of(problem) == reason
