cp -r "$ROOT/bags" .
replay bags/thesis_190_0deg bags/outside_y
replay --live --rate max bags/thesis_190_0deg
replay --update bags/[a-z]*/
report bags/thesis_190_0deg
python bags/repack.py bags/thesis_190_0deg repacked
replay --accept bags/thesis_190_0deg
