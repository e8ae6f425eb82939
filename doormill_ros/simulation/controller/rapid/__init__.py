"""RAPID from the grammar up: parser, loader and interpreter of the virtual controller."""
