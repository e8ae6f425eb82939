"""Parts of /abb_bridge: what it watches while it has the controller."""
