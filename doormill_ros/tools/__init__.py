"""Command lines: parse, call one function of the domain, print."""
