"""What the thesis prints, as typed in once in test/data/thesis/facts.yaml."""

from __future__ import annotations

import yaml

from support.source_tree import ROOT

FACTS = yaml.safe_load((ROOT / "test" / "data" / "thesis" / "facts.yaml").read_text(encoding="utf-8"))
