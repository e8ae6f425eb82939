ln -s "$ROOT/config" .
status=0
cell --door thesis_190_0deg --door thesis_1350_0deg --doors 2 --world config/worlds/example.yaml --out out/shift || status=$?
test "$status" -le 1
diagnose --inspections out/shift --out out/shift/diagnosis
diagnose --runs out/shift --out out/shift/runs
