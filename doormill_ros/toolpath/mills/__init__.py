"""Which mill cuts what: order, changes at the rack, wear."""
