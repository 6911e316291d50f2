"""An example for every call: those that schemas give, and for all else one that is made from the schema."""

from typing import Any

Json = dict[str, Any]

_OF_FORMAT = {
    "uuid": "5f0c6a2e-8f5d-4b7e-9a53-0b1d2c3e4f50",
    "date-time": "2026-05-04T09:30:00Z",
    "date": "2026-05-04",
    "email": "ada@example.org",
    "uri": "https://example.org/",
    "binary": "...",
    "password": "correct horse battery staple",
}
_DEEPEST = 12


def add_examples(document: Json) -> None:
    """Give every parameter, JSON body and JSON answer of `document` an example that its schema allows."""
    schemas = document["components"]["schemas"]
    for methods in document["paths"].values():
        for operation in methods.values():
            for parameter in operation.get("parameters", []):
                parameter.setdefault("example", example_of(parameter["schema"], schemas))
            for content in _contents(operation):
                if "examples" not in content:
                    content.setdefault("example", example_of(content["schema"], schemas))


def _contents(operation: Json) -> list[Json]:
    bodies = [operation.get("requestBody", {}), *operation["responses"].values()]
    return [
        content
        for body in bodies
        for kind, content in body.get("content", {}).items()
        if kind == "application/json" and content.get("schema")
    ]


def example_of(schema: Json, schemas: Json, depth: int = 0) -> Any:
    """Something that `schema` allows; references are looked up in `schemas`."""
    if "$ref" in schema:
        return example_of(schemas[schema["$ref"].rpartition("/")[2]], schemas, depth + 1)
    for key in ("example", "const", "default"):
        if schema.get(key) is not None:
            return schema[key]
    for key in ("examples", "enum"):
        if schema.get(key):
            return schema[key][0]
    if choices := schema.get("anyOf") or schema.get("oneOf") or schema.get("allOf"):
        return example_of(choices[0], schemas, depth + 1)
    return _of_type(schema, schemas, depth)


def _of_type(schema: Json, schemas: Json, depth: int) -> Any:
    kind = schema.get("type")
    if kind == "object":
        return {
            name: example_of(field, schemas, depth + 1)
            for name, field in schema.get("properties", {}).items()
            if depth < _DEEPEST or name in schema.get("required", ())
        }
    if kind == "array":
        n_items = max(1 if depth < _DEEPEST else 0, schema.get("minItems", 0))
        items = schema.get("prefixItems") or [schema.get("items", {})] * n_items
        return [example_of(item, schemas, depth + 1) for item in items]
    if kind in ("integer", "number"):
        return _number(schema)
    if kind == "string":
        text = _OF_FORMAT.get(schema.get("format", ""), "text")
        return text.ljust(schema.get("minLength", 0), ".")[: schema.get("maxLength")]
    return {"boolean": False, "null": None}.get(str(kind), {})


def _number(schema: Json) -> float:
    above, least = schema.get("exclusiveMinimum"), float(schema.get("minimum", 1))
    number = min(least if above is None else float(above) + 1, float(schema.get("maximum", "inf")))
    return int(number) if schema["type"] == "integer" else number
