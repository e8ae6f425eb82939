"""Causes of a difference between motor and link encoder, one file each."""
