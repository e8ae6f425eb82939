"""Pictures that the page shows, with what each shows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

#: What a picture shows, by the key of the page's texts behind "caption.".
CAPTIONS = {
    "refused": "Refused picture of door {door}",
    "found": "Door {door}: picture of {time} with the edges as they were found",
}


@dataclass(frozen=True)
class EncodedPicture:
    """An encoded picture and what it shows; `number` grows with every new one.

    `key` and `values` are those of the caption in the page's texts; an empty key: it has none there.
    """

    data: bytes
    media_type: str
    caption: str
    number: int
    key: str = ""
    values: Mapping[str, str] = field(default_factory=dict)
