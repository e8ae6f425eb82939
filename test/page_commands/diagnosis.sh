cp -r "$ROOT/docs" "$ROOT/test" .
python -m doormill_ros.tools.diagnose --data docs/diagnosis_example --out out/diagnosis
diagnose --data test/data/kr300/A --check test/data/kr300/B --out out/moving
