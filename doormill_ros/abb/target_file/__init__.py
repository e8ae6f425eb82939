"""The RAPID target file: lines, trailer, checksum, and the check of a file that was handed over."""
