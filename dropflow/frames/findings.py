"""What is worth knowing of a stack and no error: counted, with a few examples."""

from collections.abc import Iterable
from itertools import islice

from dropflow.documents import StrictModel

_MAX_EXAMPLES = 5


class Finding(StrictModel):
    """One kind of thing that was noticed."""

    code: str
    """Stable, such as ``stack.numbers_missing``."""
    message: str
    """What it means and what to do, in one line."""
    n: int
    """How often."""
    examples: tuple[str, ...] = ()
    """The first few, in plain words."""

    def __str__(self) -> str:
        """One line, examples last."""
        if not self.examples:
            return self.message
        more = ", ..." if self.n > len(self.examples) else ""
        return f"{self.message} ({'; '.join(self.examples)}{more})"


def finding(code: str, message: str, examples: Iterable[str], *, n: int) -> Finding:
    """A finding with the first few of `examples`, which are taken only so far."""
    return Finding(code=code, message=message, n=n, examples=tuple(islice(examples, _MAX_EXAMPLES)))
