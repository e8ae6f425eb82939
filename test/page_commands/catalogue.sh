export DOORMILL_CATALOGUE=$PWD/catalogue.sqlite
mkdir bags && cp -r "$ROOT/bags/thesis_190_0deg" bags/
catalogue rebuild bags
catalogue list --since 2020-01-01
catalogue list --since 2026-11-01 --failed
catalogue export --parquet runs.parquet
catalogue retain --days 365 --gigabytes 2000 --dry-run
run=$(python -c "import pandas; print(pandas.read_parquet('runs.parquet').run_id[0])")
catalogue keep "$run" --reason "customer asks"
python -c "import duckdb; duckdb.sql('SELECT cell, door_id, count(*), avg(deviation) FROM \'runs.parquet\' GROUP BY ALL').show()"
python -c "import pandas; print(pandas.read_parquet('runs.parquet').groupby('software').success.mean())"
replay --many bags
