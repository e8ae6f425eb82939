"""How fast: feeds and corners that a controller can follow, and how long a program takes."""
