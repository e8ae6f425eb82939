"""Who may order what: token, origin, tries, size of what is sent."""
