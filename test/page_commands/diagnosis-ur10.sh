mkdir -p test/data && cp -r "$ROOT/test/data/ur10" test/data/
U=test/data/ur10
diagnose --data $U/grid --data $U/joint-configurations --data $U/random-poses --out out/ur10
diagnose --data $U/grid --data $U/joint-configurations --check $U/random-poses --out out/check
