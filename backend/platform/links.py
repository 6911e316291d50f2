"""Links of the OpenAPI document: which calls the id in an answer can be given to."""

import re
from typing import Any

Json = dict[str, Any]

_ID = re.compile(r"\{(\w+_id)\}")


def add_links(document: Json) -> None:
    """Where an answer is one thing with an `id`, link to the calls that take this id in their path."""
    takers: dict[str, list[str]] = {}
    for path, methods in document["paths"].items():
        for operation in methods.values():
            if len(set(_ID.findall(path))) == 1:
                takers.setdefault(_ID.findall(path)[0], []).append(operation["operationId"])
    identified = {name for name, schema in document["components"]["schemas"].items() if "id" in _fields(schema)}
    for methods in document["paths"].values():
        for operation in methods.values():
            for status, answer in operation["responses"].items():
                if status in ("200", "201", "202"):
                    _add(answer, takers, identified)


def _fields(schema: Json) -> Json:
    fields: Json = schema.get("properties", {})
    return fields


def _add(answer: Json, takers: dict[str, list[str]], identified: set[str]) -> None:
    schema = answer.get("content", {}).get("application/json", {}).get("schema", {})
    noun = schema.get("$ref", "").rpartition("/")[2]
    if noun not in identified:
        return
    name = f"{noun.lower()}_id"
    for operation_id in takers.get(name, ()):
        link = {"operationId": operation_id, "parameters": {name: "$response.body#/id"}}
        answer.setdefault("links", {})[operation_id] = link
