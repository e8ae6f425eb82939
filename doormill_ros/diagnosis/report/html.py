"""What the pages of all diagnoses are made of: style, sections, tiles, tables."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

STYLE = """
:root{color-scheme:light}body{font:15px/1.5 system-ui,sans-serif;color:#1d2327;background:#f6f7f8;margin:0}
main{max-width:1180px;margin:auto;padding:24px}h1{font-size:24px;margin:0 0 4px}h2{font-size:18px;margin:34px 0 8px}
.tiles{display:flex;flex-wrap:wrap;gap:10px;margin:16px 0}
.tile{background:#fff;border:1px solid #dcdfe3;border-radius:6px;padding:8px 13px;flex:1 1 120px;font-size:13.5px}
.tile b{display:block;font-size:21px;white-space:nowrap}
.charts{display:grid;gap:12px;grid-template-columns:repeat(auto-fit,minmax(340px,1fr));align-items:start}
.halves{display:grid;gap:12px;grid-template-columns:repeat(auto-fit,minmax(480px,1fr))}.wide{display:grid;gap:12px}
.models td:nth-child(2){width:20%}.models td:nth-child(3){width:34%}
.bar{height:5px;margin-top:2px}.own td{font-weight:600}
svg{background:#fff;border:1px solid #dcdfe3;border-radius:6px;width:100%;height:auto}
svg .t{font:600 13px system-ui}svg .l{font:11.5px system-ui}svg .n{font:11px system-ui;fill:#555}
svg .g{stroke:#e6e9ec;stroke-width:1}svg .h{paint-order:stroke;stroke:#fff;stroke-width:3px}
table{border-collapse:collapse;background:#fff;width:100%}
td,th{border:1px solid #dcdfe3;padding:5px 9px;text-align:left;vertical-align:top}th{background:#eef0f2}
.lead{font-size:17px}.note{color:#555}
"""


def page(title: str, lead: str, parts: Sequence[str]) -> str:
    """The whole document without any outside resource; title and lead are text, parts are HTML."""
    return (
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" '
        f'content="width=device-width,initial-scale=1"><title>{escape(title)}</title><style>{STYLE}</style></head>'
        f'<body><main><h1>{escape(title)}</h1><p class="lead">{escape(lead)}</p>{"".join(parts)}</main></body></html>\n'
    )


def section(title: str, body: str) -> str:
    """A heading and HTML below it."""
    return f"<section><h2>{escape(title)}</h2>{body}</section>"


def notes(lines: Sequence[str]) -> str:
    """Remarks, one a paragraph."""
    return "".join(f'<p class="note">{escape(line)}</p>' for line in lines)


def charts(drawings: Sequence[str], layout: str = "charts") -> str:
    """Pictures side by side; layout "halves": two in a row, "wide": one below the other."""
    return f'<div class="{layout}">{"".join(drawings)}</div>'


def tiles(entries: Sequence[tuple[str, str]]) -> str:
    """Figures in large print with what they are."""
    body = "".join(f'<div class="tile"><b>{escape(a)}</b>{escape(b)}</div>' for a, b in entries)
    return f'<div class="tiles">{body}</div>'


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table of texts."""
    if not rows:
        return "<p>None.</p>"
    top = "".join(f"<th>{escape(cell)}</th>" for cell in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><tr>{top}</tr>{body}</table>"


def figure(value: Any, digits: int = 3, most: int = 12) -> str:
    """A number, or several in brackets."""
    if isinstance(value, list):
        return "(" + ", ".join(f"{v:.{digits}g}" for v in value[:most]) + ")"
    return f"{value:.{digits}g}"
