cell --door thesis_190_0deg --sensor camera --sensor photoelectric
sed -n '/^distances_mm:/,/^```/p' "$ROOT/docs/sensors.md" | grep -v '```' > distances.yaml
locate --sensor photoelectric --size 826 2040 40 distances.yaml | tee said.txt
sed -n '/^door of 826 x 2040 x 40/,/^```/p' "$ROOT/docs/sensors.md" | grep -v '```' > told.txt
grep -F -x -f told.txt -c said.txt
test "$(grep -c . told.txt)" = "$(grep -F -x -f told.txt -c said.txt)"
