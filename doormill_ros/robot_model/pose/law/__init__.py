"""Laws without a name in series of poses: which frame is displaced, and what drives that; models can carry them."""
