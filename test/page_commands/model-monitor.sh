ln -s "$ROOT/config" .
status=0
cell --door thesis_190_0deg --doors 2 --world config/worlds/gap_and_force.yaml --monitor --out out/shift || status=$?
# Doors of this world are out of tolerance, or are refused until the proposed model is accepted: 1.
test "$status" -le 1
test -s out/shift/shift.json
