ln -s "$ROOT/config" .
cell --door thesis_190_0deg --doors 4 --world config/worlds/gap_and_force.yaml --monitor --out out/shift
