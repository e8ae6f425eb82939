ln -s "$ROOT/config" .
cell --door thesis_190_0deg --door standard_door --doors 20 --world config/worlds/example.yaml --out out/shift
diagnose --inspections out/shift --out out/shift/diagnosis
