"""What a site has of its own, for tests of backups."""

from __future__ import annotations

from pathlib import Path


def fill(folder: Path, word: str = "first") -> None:
    """Files below every part, with the word in them."""
    for name in ("config/camera.yaml", "models/2026/model.yaml", "accepted/door/door_0.mcap"):
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"{word} {name}\n")
    (folder / "accepted" / "leer ö").write_bytes(b"")
