"""Exchange formats: YAML and JSON documents, Excel and CSV tables, the text table of the thesis."""
