thesis identify --out out
thesis contradictions
