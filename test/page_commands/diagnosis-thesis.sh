thesis diagnose --out out/thesis
