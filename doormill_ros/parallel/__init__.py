"""The same question to many things, by processes of this machine or by workers of a Dask scheduler."""
