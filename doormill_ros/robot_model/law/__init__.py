"""What laws without a name are made of, whatever kind of data speaks of them: carrier, driver, shape, term."""
