"""What tools and pages ask the nodes from outside, and hear of them."""
