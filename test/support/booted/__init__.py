"""A Debian of its own with the repository built in it, booted with the units of `deploy/systemd`."""
