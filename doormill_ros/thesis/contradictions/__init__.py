"""Where printed figures of the thesis' stiffness chapters contradict each other, each with its proof."""
