"""Make ``schema.json`` of DiffMA JSON from the types that documents are read with."""

import json
from pathlib import Path
from typing import Any

import msgspec

from mocapress.codecs.diffma import json_types

FILE = Path(json_types.__file__).with_name("schema.json")


def schema() -> dict[str, Any]:
    """Give the JSON Schema of a document."""
    made: dict[str, Any] = json.loads(json.dumps(msgspec.json.schema(json_types.Root)))
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "DiffMA JSON"}
    return head | made


if __name__ == "__main__":
    FILE.write_text(json.dumps(schema(), indent=2, ensure_ascii=False) + "\n")
