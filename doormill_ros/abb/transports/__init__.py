"""Ways to reach a controller, one a file, all behind `doormill_ros.abb.transport.Transport`."""
