cp -r "$ROOT/bags/thesis_190_0deg" .
replay --accept thesis_190_0deg
replay
