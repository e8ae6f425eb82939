"""Who stored a recipe, when, and as which version: no part of what is milled."""

from __future__ import annotations

STAMP = ("version", "author", "created")  #: columns of their own, not part of the stored text
