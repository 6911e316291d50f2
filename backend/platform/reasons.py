"""Why something failed, in a line."""

LONGEST = 300


def reason_of(problem: BaseException) -> str:
    """The first line of what an exception says, bounded; its kind if it says nothing."""
    lines = str(problem).strip().splitlines()
    return lines[0][:LONGEST] if lines else type(problem).__name__
