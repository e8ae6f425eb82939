"""Inspected doors as they come: kept, questioned by the diagnosis beside the running cell, and what follows of it."""
