"""Between features: ways through joint space, and what must not be touched on them."""
