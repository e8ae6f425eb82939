cp -r "$ROOT/docs" "$ROOT/test" .
python -m doormill_ros.tools.diagnose --data docs/diagnosis_example --out out/diagnosis
