"""The page that shows a diagnosis: charts as inline SVG, one file without anything from outside."""
