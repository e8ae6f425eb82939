"""Pages and charts: one template, blocks to fill it with, figures as SVG or PNG; below all that fills them."""
