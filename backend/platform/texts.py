"""Text from outside: what Postgres and UTF-8 cannot hold is refused with the name of the field."""

import unicodedata
from collections.abc import Iterator
from typing import Annotated, Any

from pydantic import AfterValidator

from dropflow.errors import FieldProblem


def unstorable(document: Any, path: str = "") -> Iterator[FieldProblem]:
    """Every text (or name of a field) in `document` that holds NUL or half of a character."""
    if isinstance(document, str) and not is_storable(document):
        yield FieldProblem(path, "holds a character that is not text (NUL or an unpaired surrogate)")
    elif isinstance(document, dict):
        for name, value in document.items():
            yield from unstorable(name, path or "(name of a field)")
            yield from unstorable(value, f"{path}.{name}".lstrip("."))
    elif isinstance(document, list | tuple):
        for index, value in enumerate(document):
            yield from unstorable(value, f"{path}.{index}".lstrip("."))


def is_storable(text: str) -> bool:
    """Whether `text` can be kept as it is."""
    return "\0" not in text and not any("\ud800" <= character <= "\udfff" for character in text)


def _storable(text: str) -> str:
    if not is_storable(text):
        raise ValueError("holds a character that is not text (NUL or an unpaired surrogate)")
    return text


Words = Annotated[str, AfterValidator(_storable)]
"""Text that may be looked for."""


def _one_line(text: str) -> str:
    if not is_storable(text) or any(unicodedata.category(character) in _NO_LINE for character in text):
        raise ValueError("must be one line of text without control characters")
    return text


_NO_LINE = ("Cc", "Cf", "Zl", "Zp")  # a name with a line break goes into a header; one that turns the text around lies
Line = Annotated[str, AfterValidator(_one_line)]
"""A name or title from outside."""
