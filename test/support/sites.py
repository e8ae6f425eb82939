"""What a site has of its own, for tests of backups."""

from __future__ import annotations

from pathlib import Path

from doormill_ros.models.store import ModelStore
from doormill_ros.operator.orders.audit import AuditEntry, AuditLog


def fill(folder: Path, word: str = "first") -> None:
    """Something in every part, with the word in it: what nodes write by their own code, the rest by hand."""
    for name in ("config/camera.yaml", "accepted/door/door_0.mcap"):
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"{word} {name}\n")
    (folder / "accepted" / "leer ö").write_bytes(b"")
    store = ModelStore(folder / "models")
    store.accept(store.propose(word.encode(), "doors"), "Kari", word)
    entry = AuditEntry(
        "2026-11-22", "operate", "Kari", "10.0.0.1", "POST /control/mill", "oak", "accepted", 202, word
    )
    AuditLog(folder / "audit").write(entry, True)
