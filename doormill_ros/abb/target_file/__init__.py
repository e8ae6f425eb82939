"""The RAPID target file: lines, trailer and checksum."""
