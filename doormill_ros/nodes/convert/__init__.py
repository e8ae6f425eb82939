"""Messages to domain types and back: no decisions, no arithmetic beyond that."""
